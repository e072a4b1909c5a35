/* FMI 2.0 co-simulation shell: phases and statuses; the rest is core.c. */

#include <stdlib.h>
#include <string.h>

#include "core.h"
#include "fmi2Functions.h"

#define ALIVE (FB_INSTANTIATED | FB_INITIALISING | FB_STEPPING | FB_TERMINATED)
#define SETTABLE (FB_INSTANTIATED | FB_INITIALISING | FB_STEPPING)
#define NEED(phases)                                                           \
  fb_instance *self = component;                                               \
  if (!self || !fb_allowed(self, __func__, phases)) return fmi2Error

static fmi2Status status(bool good) { return good ? fmi2OK : fmi2Error; }

void fb_log_error(void *environment, const void *logger, const char *name, const char *message) {
  const fmi2CallbackFunctions *functions = logger;
  char format[512];
  size_t n = 0;
  if (!functions || !functions->logger) return;
  /* The message is a printf format to the importer, but many pass it on as it is: whole, % doubled. */
  for (; *message && n < sizeof format - 2; message++) {
    if (*message == '%') format[n++] = '%';
    format[n++] = *message;
  }
  format[n] = '\0';
  functions->logger(environment, name ? name : "", fmi2Error, "logStatusError", format);
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t count,
                               const fmi2String categories[]) {
  NEED(ALIVE | FB_FAILED);
  (void)count;
  (void)categories;
  self->logging = on != fmi2False;
  return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean logging) {
  void *environment = functions ? functions->componentEnvironment : NULL;
  (void)resources, (void)visible;
  if (type != fmi2CoSimulation) {
    fb_log_error(environment, functions, name, "model exchange is not offered, co-simulation is");
    return NULL;
  }
  return fb_instantiate(name, token, environment, functions, logging != fmi2False);
}

void fmi2FreeInstance(fmi2Component component) { fb_free(component); }

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop) {
  NEED(FB_INSTANTIATED);
  (void)tolerance_defined, (void)tolerance;
  self->image.values[0] = start;
  self->image.stop_time_defined = stop_defined != fmi2False;
  self->image.stop_time = stop;
  return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  NEED(FB_INSTANTIATED);
  return status(fb_enter_initialisation(self, self->image.values[0], self->image.stop_time_defined,
                                        self->image.stop_time));
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  NEED(FB_INITIALISING);
  return status(fb_exit_initialisation(self));
}

fmi2Status fmi2Terminate(fmi2Component component) {
  NEED(FB_STEPPING);
  self->image.phase = FB_TERMINATED;
  return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component component) {
  NEED(ALIVE | FB_FAILED);
  fb_reset(self);
  return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                       fmi2Real values[]) {
  NEED(ALIVE);
  return status(fb_get(self, references, count, values));
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                       const fmi2Real values[]) {
  NEED(SETTABLE);
  return status(fb_set(self, references, count, values));
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real from, fmi2Real length, fmi2Boolean no_rollback) {
  NEED(FB_STEPPING);
  (void)no_rollback;
  return status(fb_step(self, from, length));
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state) {
  NEED(ALIVE);
  if (!*state) *state = malloc(sizeof(fb_image));
  if (!*state) return fmi2Error;
  memcpy(*state, &self->image, sizeof(fb_image));
  return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  NEED(ALIVE | FB_FAILED);
  if (!state) return fmi2Error;
  memcpy(&self->image, state, sizeof(fb_image));
  return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state) {
  NEED(ALIVE | FB_FAILED);
  free(*state);
  *state = NULL;
  return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size) {
  NEED(ALIVE);
  (void)state;
  *size = sizeof(fb_image);
  return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  NEED(ALIVE);
  if (size < sizeof(fb_image)) return fmi2Error;
  memcpy(bytes, state, sizeof(fb_image));
  return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state) {
  NEED(ALIVE | FB_FAILED);
  if (size != sizeof(fb_image)) return fmi2Error;
  if (!*state) *state = malloc(sizeof(fb_image));
  if (!*state) return fmi2Error;
  memcpy(*state, bytes, sizeof(fb_image));
  return fmi2OK;
}
