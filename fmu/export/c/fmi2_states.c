/* FMI 2.0: saved states. */

#include <stdlib.h>

#include "fmi2_shell.h"

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state) {
  NEED(FB_ALIVE);
  GIVEN(state, 1);
  return status(fb_save(self, state));
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  NEED(FB_ALIVE | FB_FAILED);
  GIVEN(state, 1);
  return status(fb_restore(self, state));
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state) {
  NEED(FB_ALIVE | FB_FAILED);
  if (!state) return fmi2OK;
  free(*state);
  *state = NULL;
  return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size) {
  NEED(FB_ALIVE | FB_FAILED);
  GIVEN(state, 1);
  GIVEN(size, 1);
  *size = fb_serial_size();
  return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  NEED(FB_ALIVE | FB_FAILED);
  GIVEN(state, 1);
  GIVEN(bytes, 1);
  return status(fb_serialise(self, state, bytes, size));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state) {
  NEED(FB_ALIVE | FB_FAILED);
  GIVEN(bytes, 1);
  GIVEN(state, 1);
  return status(fb_deserialise(self, bytes, size, state));
}
