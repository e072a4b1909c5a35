/* What the files of the FMI 2.0 shell share. */

#ifndef FB_FMI2_SHELL_H
#define FB_FMI2_SHELL_H

#include "core.h"
#include "fmi2Functions.h"

/* Some copies of FMI's header know no prefix, by which several models link into one program. */
#ifdef FMI2_FUNCTION_PREFIX
#define FB_PASTE(prefix, name) prefix##name
#define FB_PREFIXED(prefix, name) FB_PASTE(prefix, name)
#undef fmi2FullName
#define fmi2FullName(name) FB_PREFIXED(FMI2_FUNCTION_PREFIX, name)
#endif

/* Let a call through in these phases only. */
#define NEED(phases)                                                           \
  fb_instance *self = component;                                               \
  if (!self || !fb_allowed(self, __func__, phases)) return fmi2Error

/* Refuse a NULL where `count` values are to be read or written. */
#define GIVEN(argument, count)                                                 \
  if (!fb_given(self, __func__, #argument, argument, count)) return fmi2Error

FB_INLINE fmi2Status status(bool good) { return good ? fmi2OK : fmi2Error; }

#endif
