/* What the files of the FMI 3.0 shell share. */

#ifndef FB_FMI3_SHELL_H
#define FB_FMI3_SHELL_H

#include "core.h"
#include "fmi3Functions.h"

/* Let a call through in these phases only. */
#define NEED(phases)                                                           \
  fb_instance *self = instance;                                                \
  if (!self || !fb_allowed(self, __func__, phases)) return fmi3Error

static inline fmi3Status status(bool good) { return good ? fmi3OK : fmi3Error; }

#endif
