/* FMI 2.0 model exchange, and directional derivatives of both interfaces.
   A switch changes in event mode; nothing else does. */

#include "fmi2_shell.h"

fmi2Status fmi2EnterEventMode(fmi2Component component) {
  NEED(FB_EVENT | FB_CONTINUOUS);
  fb_move(self, FB_EVENT);
  return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component component, fmi2EventInfo *info) {
  NEED(FB_EVENT);
  GIVEN(info, 1);
  info->newDiscreteStatesNeeded = fmi2False;
  info->terminateSimulation = fmi2False;
  info->nominalsOfContinuousStatesChanged = fmi2False;
  info->valuesOfContinuousStatesChanged = fmi2False;
  info->nextEventTimeDefined = fmi2False;
  info->nextEventTime = 0.0;
  return fmi2OK;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component component) {
  NEED(FB_EVENT);
  fb_move(self, FB_CONTINUOUS);
  return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component component, fmi2Boolean no_rollback,
                                       fmi2Boolean *enter_event_mode, fmi2Boolean *terminate) {
  NEED(FB_CONTINUOUS);
  GIVEN(enter_event_mode, 1);
  GIVEN(terminate, 1);
  (void)no_rollback;
  *enter_event_mode = fmi2False;
  *terminate = fmi2False;
  return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component component, fmi2Real time) {
  NEED(FB_EVENT | FB_CONTINUOUS);
  return status(fb_set_time(self, time));
}

fmi2Status fmi2SetContinuousStates(fmi2Component component, const fmi2Real states[], size_t count) {
  NEED(FB_CONTINUOUS);
  GIVEN(states, count);
  return status(fb_set_states(self, states, count));
}

fmi2Status fmi2GetContinuousStates(fmi2Component component, fmi2Real states[], size_t count) {
  NEED(FB_INITIALISING | FB_EVENT | FB_CONTINUOUS | FB_TERMINATED);
  GIVEN(states, count);
  return status(fb_get_states(self, states, count));
}

fmi2Status fmi2GetDerivatives(fmi2Component component, fmi2Real rates[], size_t count) {
  NEED(FB_INITIALISING | FB_EVENT | FB_CONTINUOUS | FB_TERMINATED);
  GIVEN(rates, count);
  return (fmi2Status)fb_get_rates(self, rates, count);
}

fmi2Status fmi2GetEventIndicators(fmi2Component component, fmi2Real indicators[], size_t count) {
  NEED(FB_INITIALISING | FB_EVENT | FB_CONTINUOUS | FB_TERMINATED);
  GIVEN(indicators, count);
  return status(fb_get_indicators(self, indicators, count));
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component component, fmi2Real nominals[], size_t count) {
  NEED(FB_ALIVE);
  GIVEN(nominals, count);
  return status(fb_get_nominals(self, nominals, count));
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference unknowns[],
                                        size_t unknown_count, const fmi2ValueReference knowns[],
                                        size_t known_count, const fmi2Real seed[], fmi2Real sensitivity[]) {
  NEED(FB_INITIALISING | FB_RUNNING | FB_TERMINATED);
  GIVEN(unknowns, unknown_count);
  GIVEN(knowns, known_count);
  GIVEN(seed, known_count);
  GIVEN(sensitivity, unknown_count);
  return status(fb_slopes(self, unknowns, unknown_count, knowns, known_count, seed, sensitivity));
}
