/* Prints what the C interface gives for the experiments of UnityTest.cs: one line per result, "name value".
 * Usage: reference EXAMPLES */
#include <inttypes.h>
#include <palpate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char* kInclusions =
    "[organ]\nmesh = \"liver\"\n[tool]\nmesh = \"sphere:5\"\n[[organ.inclusion]]\npreset = \"nodule\"\n";

static void check(palpate_status status) {
  if (status == PALPATE_OK) return;
  fprintf(stderr, "reference: %s\n", palpate_last_error());
  exit(1);
}

/* FNV-1a, 64 bits. */
static uint64_t hash(uint64_t so_far, const void* data, size_t size) {
  const unsigned char* byte = data;
  for (size_t i = 0; i < size; ++i) so_far = (so_far ^ byte[i]) * UINT64_C(1099511628211);
  return so_far;
}

static void change(palpate_simulation* simulation, const char* name, uint64_t tick) {
  if (strcmp(name, "parameters") == 0) {
    if (tick == 1400) check(palpate_set_tissue(simulation, "liver"));
    if (tick == 1700) check(palpate_set_tissue_value(simulation, "rest_length_mm", 10.25));
    if (tick == 2000) check(palpate_set_noise(simulation, 1, 2e-5, 4e-3));
  }
  if (strcmp(name, "inclusion") == 0 && tick == 1500) {
    palpate_inclusion nodule = {0};
    nodule.struct_size = sizeof nodule;
    check(palpate_get_inclusion(simulation, 0, &nodule));
    nodule.position[2] -= 0.001;
    nodule.stiffness_ratio = 0.1;
    check(palpate_set_inclusion(simulation, 0, &nodule));
  }
}

static void print_surface(palpate_simulation* simulation, const palpate_info* info) {
  palpate_picture picture = {0};
  picture.struct_size = sizeof picture;
  check(palpate_surface_update(simulation, &picture));
  double* xyz = malloc(3 * info->vertices * sizeof *xyz);
  int32_t* corners = malloc(3 * info->triangles * sizeof *corners);
  if (xyz == NULL || corners == NULL) exit(1);
  check(palpate_surface_vertices(simulation, xyz, info->vertices));
  check(palpate_surface_triangles(simulation, corners, info->triangles));
  double volume = 0.0;
  for (size_t i = 0; i < info->triangles; ++i) {
    const double* a = xyz + 3 * corners[3 * i];
    const double* b = xyz + 3 * corners[3 * i + 1];
    const double* c = xyz + 3 * corners[3 * i + 2];
    volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0])) / 6.0;
  }
  printf("volume %.17g\n", volume);
  printf("vertices %016" PRIx64 "\n",
         hash(UINT64_C(14695981039346656037), xyz, 3 * info->vertices * sizeof *xyz));
  printf("tool_z %.17g\n", picture.tool_position[0][2]);
  free(xyz);
  free(corners);
}

static void experiment(const char* name, palpate_options options) {
  options.struct_size = sizeof options;
  options.no_cache = 1;
  palpate_simulation* simulation = NULL;
  check(palpate_open(&options, &simulation));
  palpate_info info = {0};
  info.struct_size = sizeof info;
  check(palpate_get_info(simulation, &info));
  palpate_sample samples[PALPATE_MAX_HANDS] = {{0}};
  palpate_result results[PALPATE_MAX_HANDS] = {{0}};
  for (uint32_t hand = 0; hand < info.hands; ++hand) {
    samples[hand].struct_size = sizeof samples[hand];
    results[hand].struct_size = sizeof results[hand];
  }
  uint64_t all = UINT64_C(14695981039346656037);
  for (uint64_t tick = 0; tick < 2500; ++tick) {
    change(simulation, name, tick);
    for (uint32_t hand = 0; hand < info.hands; ++hand) {
      check(palpate_scripted_sample(simulation, hand, tick, &samples[hand]));
    }
    check(palpate_tick(simulation, samples, results, info.hands));
    all = hash(all, results, info.hands * sizeof *results);
  }
  printf("%s %016" PRIx64 "\n", name, all);
  printf("%s_depth %.17g\n", name, results[0].depth);
  printf("%s_force %.17g\n", name, results[0].tissue_force);
  if (strcmp(name, "press") == 0) print_surface(simulation, &info);
  check(palpate_close(simulation));
}

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  char two_hands[4096];
  snprintf(two_hands, sizeof two_hands, "%s/bimanual.toml", argv[1]);
  palpate_options none = {0};
  none.no_hand = 1;
  palpate_options pull = none;
  pull.task = "pull";
  palpate_options two = none;
  two.scene_file = two_hands;
  palpate_options held = {0};
  palpate_options inclusion = none;
  inclusion.scene_text = kInclusions;
  experiment("press", none);
  experiment("pull", pull);
  experiment("two", two);
  experiment("held", held);
  experiment("parameters", none);
  experiment("inclusion", inclusion);
  palpate_options wrong = none;
  wrong.struct_size = sizeof wrong;
  wrong.scene_text = "[organ]\nmesh = \"gallbladder\"\nweight = 1\n";
  palpate_simulation* simulation = NULL;
  palpate_open(&wrong, &simulation);
  printf("error %s\n", palpate_last_error());
  return 0;
}
