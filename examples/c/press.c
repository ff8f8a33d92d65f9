/* Presses the built-in gallbladder from C99: open a scene, tick, read the force and the deformed surface.
 *
 * The samples come from a path of the library, so no hand holds a device (no_hand = 1). For a device of your
 * own, leave no_hand at 0, fill the samples from the device, call palpate_tick() at info.rate from your
 * real-time thread, and write result.device_force to the device unchanged.
 *
 * Usage: press [SCENE.toml] */
#include <math.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>

static void check(palpate_status status) {
  if (status == PALPATE_OK) return;
  fprintf(stderr, "press: %s\n", palpate_last_error());
  exit(2);
}

static double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* Largest displacement of a vertex [m]. */
static double largest_move(const double* rest, const double* now, size_t vertices) {
  double most = 0.0;
  for (size_t i = 0; i < vertices; ++i) {
    const double way[3] = {now[3 * i] - rest[3 * i], now[3 * i + 1] - rest[3 * i + 1],
                           now[3 * i + 2] - rest[3 * i + 2]};
    if (length(way) > most) most = length(way);
  }
  return most;
}

int main(int argc, char** argv) {
  if (palpate_abi_version() != PALPATE_ABI_VERSION) {
    fprintf(stderr, "press: libpalpate %s is not the one this was compiled for\n", palpate_version());
    return 2;
  }
  palpate_options options = {0};
  options.struct_size = sizeof options;
  options.scene_file = argc > 1 ? argv[1] : NULL;
  options.no_hand = 1;
  palpate_simulation* simulation = NULL;
  check(palpate_open(&options, &simulation));

  palpate_info info = {0};
  info.struct_size = sizeof info;
  check(palpate_get_info(simulation, &info));
  for (size_t i = 0; palpate_remark(simulation, i) != NULL; ++i)
    printf("note: %s\n", palpate_remark(simulation, i));
  printf("%s: %u hand(s) at %g Hz, %zu vertices, %zu triangles\n", palpate_name(simulation),
         (unsigned)info.hands, info.rate, info.vertices, info.triangles);

  double* rest = malloc(3 * info.vertices * sizeof *rest);
  double* now = malloc(3 * info.vertices * sizeof *now);
  if (rest == NULL || now == NULL) return 1;
  check(palpate_surface_vertices(simulation, rest, info.vertices)); /* before the first tick: at rest */

  palpate_sample samples[PALPATE_MAX_HANDS] = {{0}};
  palpate_result results[PALPATE_MAX_HANDS] = {{0}};
  palpate_picture picture = {0};
  picture.struct_size = sizeof picture;
  double largest_force = 0.0;
  double deepest = 0.0;
  for (uint64_t tick = 0; tick < info.scripted_ticks; ++tick) {
    for (uint32_t hand = 0; hand < info.hands; ++hand) {
      samples[hand].struct_size = sizeof samples[hand];
      results[hand].struct_size = sizeof results[hand];
      check(palpate_scripted_sample(simulation, hand, tick, &samples[hand])); /* your device here */
    }
    check(palpate_tick(simulation, samples, results, info.hands));
    for (uint32_t hand = 0; hand < info.hands; ++hand) {
      const palpate_result* result = &results[hand]; /* result->device_force to your device here */
      if (result->fault != PALPATE_FAULT_NONE)
        printf("hand %u: %s\n", (unsigned)hand, palpate_fault_words(result->fault));
      if (length(result->force) > largest_force) largest_force = length(result->force);
      if (result->depth > deepest) deepest = result->depth;
    }
    if (tick % 500 == 0) {
      check(palpate_surface_update(simulation, &picture));
      check(palpate_surface_vertices(simulation, now, info.vertices));
      printf("%5.2f s  distance %7.2f mm  force %6.3f N  surface moved %5.2f mm\n", results[0].time,
             1e3 * results[0].distance, length(results[0].force),
             1e3 * largest_move(rest, now, info.vertices));
    }
  }
  printf("deepest %.17g m, largest force %.17g N\n", deepest, largest_force);
  free(rest);
  free(now);
  check(palpate_close(simulation));
  return 0;
}
