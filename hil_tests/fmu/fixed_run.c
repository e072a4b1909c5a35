/* The fixed run of fmu/fingerprint.py on another machine: writes the bits of all outputs after each step.

   fixed_run LIBRARY TOKEN STEP_S INPUT:NOMINAL ... / OUTPUT ...      (value references; FMI is 2 or 3) */

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <fcntl.h>
#include <io.h>
#include <windows.h>
static void *found(void *library, const char *name) { return (void *)GetProcAddress((HMODULE)library, name); }
static void *opened(const char *path) { return (void *)LoadLibraryA(path); }
#else
#include <dlfcn.h>
static void *found(void *library, const char *name) { return dlsym(library, name); }
static void *opened(const char *path) { return dlopen(path, RTLD_NOW); }
#endif

#define MOST 64
#define STEPS 400
#define STEPS_A_JUMP 25

#if FMI == 2
#define CALL(name) found(library, "fmi2" name)
#else
#define CALL(name) found(library, "fmi3" name)
#endif

static void *library, *plant;
static unsigned inputs[MOST], outputs[MOST];
static double nominals[MOST], values[MOST];
static size_t input_count, output_count;

static void need(const char *what, bool good) {
  if (good) return;
  fprintf(stderr, "%s failed\n", what);
  exit(1);
}

static void begin(const char *token) {
#if FMI == 2
  void *(*make)(const char *, int, const char *, const char *, const void *, int, int) = CALL("Instantiate");
  int (*setup)(void *, int, double, double, int, double) = CALL("SetupExperiment");
  int (*enter)(void *) = CALL("EnterInitializationMode");
  need("instantiate", (plant = make("run", 1, token, "", NULL, 0, 0)) != NULL);
  need("setup", setup(plant, 0, 0.0, 0.0, 0, 0.0) == 0);
  need("enter", enter(plant) == 0);
#else
  void *(*make)(const char *, const char *, const char *, bool, bool, bool, bool, const unsigned *, size_t,
                void *, void *, void *) = CALL("InstantiateCoSimulation");
  int (*enter)(void *, bool, double, double, bool, double) = CALL("EnterInitializationMode");
  need("instantiate", (plant = make("run", token, "", 0, 0, 0, 0, NULL, 0, NULL, NULL, NULL)) != NULL);
  need("enter", enter(plant, 0, 0.0, 0.0, 0, 0.0) == 0);
#endif
  int (*leave)(void *) = CALL("ExitInitializationMode");
  need("leave", leave(plant) == 0);
}

static void step(double at, double length) {
#if FMI == 2
  int (*forward)(void *, double, double, int) = CALL("DoStep");
  int (*get)(void *, const unsigned *, size_t, double *) = CALL("GetReal");
  need("step", forward(plant, at, length, 0) <= 1);
  need("get", get(plant, outputs, output_count, values) <= 1);
#else
  int (*forward)(void *, double, double, bool, bool *, bool *, bool *, double *) = CALL("DoStep");
  int (*get)(void *, const unsigned *, size_t, double *, size_t) = CALL("GetFloat64");
  bool event, end, early;
  double last;
  need("step", forward(plant, at, length, 0, &event, &end, &early, &last) <= 1);
  need("get", get(plant, outputs, output_count, values, output_count) <= 1);
#endif
}

static void jump(unsigned long long *state) {
  double jumped[MOST];
  size_t i;
  for (i = 0; i < input_count; i++) {
    *state = (*state * 1103515245ULL + 12345ULL) % 2147483648ULL;
    jumped[i] = nominals[i] * ((double)*state / 1073741824.0 - 1.0);
  }
#if FMI == 2
  int (*set)(void *, const unsigned *, size_t, const double *) = CALL("SetReal");
  need("set", set(plant, inputs, input_count, jumped) <= 1);
#else
  int (*set)(void *, const unsigned *, size_t, const double *, size_t) = CALL("SetFloat64");
  need("set", set(plant, inputs, input_count, jumped, input_count) <= 1);
#endif
}

int main(int count, char **words) {
  unsigned long long state = 1;
  bool reading = false;
  double length;
  int i, n;
  need("usage", count > 4);
#ifdef _WIN32
  _setmode(_fileno(stdout), _O_BINARY);
#endif
  need("load", (library = opened(words[1])) != NULL);
  length = strtod(words[3], NULL);
  for (i = 4; i < count; i++) {
    if (!strcmp(words[i], "/")) reading = true;
    else if (reading) outputs[output_count++] = (unsigned)strtoul(words[i], NULL, 10);
    else {
      inputs[input_count] = (unsigned)strtoul(words[i], NULL, 10);
      nominals[input_count++] = strtod(strchr(words[i], ':') + 1, NULL);
    }
  }
  begin(words[2]);
  for (n = 0; n < STEPS; n++) {
    if (n % STEPS_A_JUMP == 0) jump(&state);
    step(n * length, length);
    need("write", fwrite(values, sizeof *values, output_count, stdout) == output_count);
  }
  return 0;
}
