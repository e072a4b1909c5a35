/* FMI 3.0 shell: phases, values, co-simulation steps. The rest of FMI 3.0 is in fmi3_exchange.c,
   fmi3_states.c and fmi3_absent.c; the work is done in core.c and its neighbours. */

#include <string.h>

#include "fmi3_shell.h"

void fb_emit(void *environment, const void *logger, const char *name, fb_level level, const char *message) {
  fmi3LogMessageCallback log;
  (void)name;
  memcpy(&log, &logger, sizeof log);
  if (log) log(environment, (fmi3Status)level, fb_categories[level], message);
}

const char *fmi3GetVersion(void) { return "3.0"; }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t count,
                               const fmi3String categories[]) {
  NEED(FB_ALIVE | FB_FAILED);
  GIVEN(categories, count);
  return fb_listen(self, on, count, categories) ? fmi3OK : fmi3Warning;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                         fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean events,
                                         fmi3Boolean early, const fmi3ValueReference required[], size_t count,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update) {
  const void *logger;
  fb_instance *instance;
  (void)resources, (void)visible, (void)required, (void)update;
  memcpy(&logger, &log, sizeof logger);
  if (events) {
    fb_emit(environment, logger, name, FB_ERROR,
            "instantiate: eventModeUsed is true, but co-simulation has no event mode here (hasEventMode)");
    return NULL;
  }
  if (count > 0) {
    fb_emit(environment, logger, name, FB_ERROR, "instantiate: there are no intermediate variables");
    return NULL;
  }
  instance = fb_instantiate(name, token, environment, logger, logging, false);
  if (instance && early)
    fb_say(instance, FB_WARNING, "earlyReturnAllowed is true, but no step here returns early");
  return instance;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                          fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
  const void *logger;
  (void)resources, (void)visible;
  memcpy(&logger, &log, sizeof logger);
  return fb_instantiate(name, token, environment, logger, logging, true);
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
  NEED(FB_RUNNING);
  fb_move(self, FB_TERMINATED);
  return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance) {
  NEED(FB_ALIVE | FB_FAILED);
  fb_reset(self);
  fb_say(self, FB_OK, "reset");
  return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                          fmi3Float64 values[], size_t value_count) {
  NEED(FB_ALIVE);
  GIVEN(references, count);
  GIVEN(values, count);
  if (value_count != count) {
    fb_fail(self, "fmi3GetFloat64: %u values for %u variables", (unsigned)value_count, (unsigned)count);
    return fmi3Error;
  }
  return status(fb_get(self, references, count, values));
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                          const fmi3Float64 values[], size_t value_count) {
  NEED(FB_ALIVE & ~FB_TERMINATED);
  GIVEN(references, count);
  GIVEN(values, count);
  if (value_count != count) {
    fb_fail(self, "fmi3SetFloat64: %u values for %u variables", (unsigned)value_count, (unsigned)count);
    return fmi3Error;
  }
  return (fmi3Status)fb_set(self, references, count, values);
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
