/* What the files of the FMI 2.0 shell share. */

#ifndef FB_FMI2_SHELL_H
#define FB_FMI2_SHELL_H

#include "core.h"
#include "fmi2Functions.h"

/* Let a call through in these phases only. */
#define NEED(phases)                                                           \
  fb_instance *self = component;                                               \
  if (!self || !fb_allowed(self, __func__, phases)) return fmi2Error

/* Refuse a NULL where `count` values are to be read or written. */
#define GIVEN(argument, count)                                                 \
  if (!fb_given(self, __func__, #argument, argument, count)) return fmi2Error

FB_INLINE fmi2Status status(bool good) { return good ? fmi2OK : fmi2Error; }

#endif
