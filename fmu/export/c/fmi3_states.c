/* FMI 3.0: saved states. */

#include <stdlib.h>

#include "fmi3_shell.h"

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state) {
  NEED(FB_ALIVE);
  GIVEN(state, 1);
  return status(fb_save(self, state));
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  NEED(FB_ALIVE | FB_FAILED);
  GIVEN(state, 1);
  return status(fb_restore(self, state));
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state) {
  NEED(FB_ALIVE | FB_FAILED);
  if (!state) return fmi3OK;
  free(*state);
  *state = NULL;
  return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size) {
  NEED(FB_ALIVE | FB_FAILED);
  GIVEN(state, 1);
  GIVEN(size, 1);
  *size = fb_serial_size();
  return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
  NEED(FB_ALIVE | FB_FAILED);
  GIVEN(state, 1);
  GIVEN(bytes, 1);
  return status(fb_serialise(self, state, (char *)bytes, size));
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
                                   fmi3FMUState *state) {
  NEED(FB_ALIVE | FB_FAILED);
  GIVEN(bytes, 1);
  GIVEN(state, 1);
  return status(fb_deserialise(self, (const char *)bytes, size, state));
}
