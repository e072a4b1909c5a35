/* What the files of the FMI 3.0 shell share. */

#ifndef FB_FMI3_SHELL_H
#define FB_FMI3_SHELL_H

#include "core.h"
#include "fmi3Functions.h"

/* Let a call through in these phases only. */
#define NEED(phases)                                                           \
  fb_instance *self = instance;                                                \
  if (!self || !fb_allowed(self, __func__, phases)) return fmi3Error

/* Refuse a NULL where `count` values are to be read or written. */
#define GIVEN(argument, count)                                                 \
  if (!fb_given(self, __func__, #argument, argument, count)) return fmi3Error

FB_INLINE fmi3Status status(bool good) { return good ? fmi3OK : fmi3Error; }

#endif
