/* Presses the built-in gallbladder on its own path and prints the bits of every tick's force and torque, to compare
 * builds of the library (tools/check_platforms). Records the run as CSV, under a name outside ASCII. */
#include <inttypes.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void check(palpate_status status) {
  if (status == PALPATE_OK) return;
  fprintf(stderr, "forces: %s\n", palpate_last_error());
  exit(2);
}

static void print_bits(const double values[3]) {
  for (int i = 0; i < 3; ++i) {
    uint64_t bits = 0;
    memcpy(&bits, &values[i], sizeof bits);
    printf(" %016" PRIx64, bits);
  }
}

int main(void) {
  palpate_options options = {0};
  options.struct_size = sizeof options;
  options.record_file = "gedr\xc3\xbc" "ckt.csv";
  options.record_waits = 1;
  options.no_hand = 1;
  options.no_cache = 1;
  palpate_simulation* simulation = NULL;
  check(palpate_open(&options, &simulation));
  palpate_info info = {0};
  info.struct_size = sizeof info;
  check(palpate_get_info(simulation, &info));
  palpate_sample sample = {0};
  palpate_result result = {0};
  sample.struct_size = sizeof sample;
  result.struct_size = sizeof result;
  for (uint64_t tick = 0; tick < info.scripted_ticks; ++tick) {
    check(palpate_scripted_sample(simulation, 0, tick, &sample));
    check(palpate_tick(simulation, &sample, &result, 1));
    printf("%" PRIu64, result.tick);
    print_bits(result.force);
    print_bits(result.torque);
    printf("\n");
  }
  check(palpate_close(simulation));
  return 0;
}
