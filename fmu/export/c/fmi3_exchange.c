/* FMI 3.0 model exchange, and directional derivatives of both interfaces.
   A switch changes in event mode; nothing else does. */

#include "fmi3_shell.h"

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
  NEED(FB_CONTINUOUS);
  fb_move(self, FB_EVENT);
  return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *update, fmi3Boolean *terminate,
                                    fmi3Boolean *nominals, fmi3Boolean *values, fmi3Boolean *defined,
                                    fmi3Float64 *next) {
  NEED(FB_EVENT);
  GIVEN(update, 1);
  GIVEN(terminate, 1);
  GIVEN(nominals, 1);
  GIVEN(values, 1);
  GIVEN(defined, 1);
  GIVEN(next, 1);
  *update = *terminate = *nominals = *values = *defined = false;
  *next = 0.0;
  return fmi3OK;
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
  NEED(FB_EVENT);
  fb_move(self, FB_CONTINUOUS);
  return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean no_rollback,
                                       fmi3Boolean *enter_event_mode, fmi3Boolean *terminate) {
  NEED(FB_CONTINUOUS);
  GIVEN(enter_event_mode, 1);
  GIVEN(terminate, 1);
  (void)no_rollback;
  *enter_event_mode = *terminate = false;
  return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
  NEED(FB_CONTINUOUS);
  return status(fb_set_time(self, time));
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[], size_t count) {
  NEED(FB_CONTINUOUS);
  GIVEN(states, count);
  return status(fb_set_states(self, states, count));
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 states[], size_t count) {
  NEED(FB_INITIALISING | FB_EVENT | FB_CONTINUOUS | FB_TERMINATED);
  GIVEN(states, count);
  return status(fb_get_states(self, states, count));
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 rates[], size_t count) {
  NEED(FB_INITIALISING | FB_EVENT | FB_CONTINUOUS | FB_TERMINATED);
  GIVEN(rates, count);
  return (fmi3Status)fb_get_rates(self, rates, count);
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 indicators[], size_t count) {
  NEED(FB_INITIALISING | FB_EVENT | FB_CONTINUOUS | FB_TERMINATED);
  GIVEN(indicators, count);
  return status(fb_get_indicators(self, indicators, count));
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 nominals[], size_t count) {
  NEED(FB_ALIVE);
  GIVEN(nominals, count);
  return status(fb_get_nominals(self, nominals, count));
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *count) {
  NEED(FB_ALIVE);
  GIVEN(count, 1);
  *count = FB_INDICATORS;
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *count) {
  NEED(FB_ALIVE);
  GIVEN(count, 1);
  *count = FB_STATES;
  return fmi3OK;
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[],
                                        size_t unknown_count, const fmi3ValueReference knowns[],
                                        size_t known_count, const fmi3Float64 seed[], size_t seed_count,
                                        fmi3Float64 sensitivity[], size_t sensitivity_count) {
  NEED(FB_INITIALISING | FB_RUNNING | FB_TERMINATED);
  GIVEN(unknowns, unknown_count);
  GIVEN(knowns, known_count);
  GIVEN(seed, seed_count);
  GIVEN(sensitivity, sensitivity_count);
  if (seed_count != known_count || sensitivity_count != unknown_count) {
    fb_fail(self, "fmi3GetDirectionalDerivative: %u seeds for %u knowns, %u places for %u unknowns",
            (unsigned)seed_count, (unsigned)known_count, (unsigned)sensitivity_count, (unsigned)unknown_count);
    return fmi3Error;
  }
  return status(fb_slopes(self, unknowns, unknown_count, knowns, known_count, seed, sensitivity));
}
