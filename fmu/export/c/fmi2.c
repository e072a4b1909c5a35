/* FMI 2.0 shell: phases, values, co-simulation steps. The rest of FMI 2.0 is in fmi2_exchange.c,
   fmi2_states.c and fmi2_absent.c; the work is done in core.c and its neighbours. */

#include <string.h>

#include "fmi2_shell.h"

void fb_emit(void *environment, const void *logger, const char *name, fb_level level, const char *message) {
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
  functions->logger(environment, name ? name : "", (fmi2Status)level, fb_categories[level], format);
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t count,
                               const fmi2String categories[]) {
  NEED(FB_ALIVE | FB_FAILED);
  GIVEN(categories, count);
  return fb_listen(self, on != fmi2False, count, categories) ? fmi2OK : fmi2Warning;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible,
                              fmi2Boolean logging) {
  void *environment = functions ? functions->componentEnvironment : NULL;
  (void)resources, (void)visible;
  return fb_instantiate(name, token, environment, functions, logging != fmi2False, type == fmi2ModelExchange);
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
  NEED(FB_RUNNING);
  fb_move(self, FB_TERMINATED);
  return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component component) {
  NEED(FB_ALIVE | FB_FAILED);
  fb_reset(self);
  fb_say(self, FB_OK, "reset");
  return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                       fmi2Real values[]) {
  NEED(FB_ALIVE);
  GIVEN(references, count);
  GIVEN(values, count);
  return status(fb_get(self, references, count, values));
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                       const fmi2Real values[]) {
  NEED(FB_ALIVE & ~FB_TERMINATED);
  GIVEN(references, count);
  GIVEN(values, count);
  return (fmi2Status)fb_set(self, references, count, values);
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real from, fmi2Real length, fmi2Boolean no_rollback) {
  NEED(FB_STEPPING);
  (void)no_rollback;
  return status(fb_step(self, from, length));
}
