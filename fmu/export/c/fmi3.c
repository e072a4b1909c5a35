/* FMI 3.0 co-simulation shell: phases and statuses; the rest is core.c. */

#include <stdlib.h>
#include <string.h>

#include "core.h"
#include "fmi3Functions.h"

#define ALIVE (FB_INSTANTIATED | FB_INITIALISING | FB_STEPPING | FB_TERMINATED)
#define SETTABLE (FB_INSTANTIATED | FB_INITIALISING | FB_STEPPING)
#define NEED(phases)                                                           \
  fb_instance *self = instance;                                                \
  if (!self || !fb_allowed(self, __func__, phases)) return fmi3Error

static fmi3Status status(bool good) { return good ? fmi3OK : fmi3Error; }

void fb_log_error(void *environment, const void *logger, const char *name, const char *message) {
  fmi3LogMessageCallback log;
  (void)name;
  memcpy(&log, &logger, sizeof log);
  if (log) log(environment, fmi3Error, "logStatusError", message);
}

const char *fmi3GetVersion(void) { return "3.0"; }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t count,
                               const fmi3String categories[]) {
  NEED(ALIVE | FB_FAILED);
  (void)count;
  (void)categories;
  self->logging = on;
  return fmi3OK;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                         fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean events,
                                         fmi3Boolean early, const fmi3ValueReference required[], size_t count,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update) {
  const void *logger;
  (void)resources, (void)visible, (void)events, (void)early, (void)required, (void)update;
  memcpy(&logger, &log, sizeof logger);
  if (count > 0) {
    fb_log_error(environment, logger, name, "instantiate: there are no intermediate variables");
    return NULL;
  }
  return fb_instantiate(name, token, environment, logger, logging);
}

void fmi3FreeInstance(fmi3Instance instance) { fb_free(instance); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerance_defined,
                                       fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean stop_defined,
                                       fmi3Float64 stop) {
  NEED(FB_INSTANTIATED);
  (void)tolerance_defined, (void)tolerance;
  return status(fb_enter_initialisation(self, start, stop_defined, stop));
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  NEED(FB_INITIALISING);
  return status(fb_exit_initialisation(self));
}

fmi3Status fmi3Terminate(fmi3Instance instance) {
  NEED(FB_STEPPING);
  self->image.phase = FB_TERMINATED;
  return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance) {
  NEED(ALIVE | FB_FAILED);
  fb_reset(self);
  return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                          fmi3Float64 values[], size_t value_count) {
  NEED(ALIVE);
  if (value_count != count) {
    fb_fail(self, "fmi3GetFloat64: %u values for %u variables", (unsigned)value_count, (unsigned)count);
    return fmi3Error;
  }
  return status(fb_get(self, references, count, values));
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                          const fmi3Float64 values[], size_t value_count) {
  NEED(SETTABLE);
  if (value_count != count) {
    fb_fail(self, "fmi3SetFloat64: %u values for %u variables", (unsigned)value_count, (unsigned)count);
    return fmi3Error;
  }
  return status(fb_set(self, references, count, values));
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 from, fmi3Float64 length, fmi3Boolean no_rollback,
                      fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last) {
  bool good;
  NEED(FB_STEPPING);
  (void)no_rollback;
  good = fb_step(self, from, length);
  if (event) *event = false;
  if (terminate) *terminate = false;
  if (early) *early = false;
  if (last) *last = self->image.values[0];
  return status(good);
}

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state) {
  NEED(ALIVE);
  if (!*state) *state = malloc(sizeof(fb_image));
  if (!*state) return fmi3Error;
  memcpy(*state, &self->image, sizeof(fb_image));
  return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  NEED(ALIVE | FB_FAILED);
  if (!state) return fmi3Error;
  memcpy(&self->image, state, sizeof(fb_image));
  return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state) {
  NEED(ALIVE | FB_FAILED);
  free(*state);
  *state = NULL;
  return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size) {
  NEED(ALIVE);
  (void)state;
  *size = sizeof(fb_image);
  return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
  NEED(ALIVE);
  if (size < sizeof(fb_image)) return fmi3Error;
  memcpy(bytes, state, sizeof(fb_image));
  return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
                                   fmi3FMUState *state) {
  NEED(ALIVE | FB_FAILED);
  if (size != sizeof(fb_image)) return fmi3Error;
  if (!*state) *state = malloc(sizeof(fb_image));
  if (!*state) return fmi3Error;
  memcpy(*state, bytes, sizeof(fb_image));
  return fmi3OK;
}
