/* Messages of an instance: errors always, the others as the master switched their categories. */

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core.h"

#define FB_MESSAGE 256

const char *const fb_categories[4] = {"logEvents", "logStatusWarning", "logStatusDiscard", "logStatusError"};

static void say(fb_instance *instance, fb_level level, const char *format, va_list arguments) {
  char message[FB_MESSAGE];
  vsnprintf(message, sizeof message, format, arguments);
  fb_emit(instance->environment, instance->logger, instance->name, level, message);
}

void fb_say(fb_instance *instance, fb_level level, const char *format, ...) {
  va_list arguments;
  if (level != FB_ERROR && !(instance->levels >> level & 1)) return;
  va_start(arguments, format);
  say(instance, level, format, arguments);
  va_end(arguments);
}

void fb_fail(fb_instance *instance, const char *format, ...) {
  va_list arguments;
  instance->image.phase = FB_FAILED;
  va_start(arguments, format);
  say(instance, FB_ERROR, format, arguments);
  va_end(arguments);
}

bool fb_allowed(fb_instance *instance, const char *function, int phases) {
  static const char *const names[] = {"instantiated", "initialisation mode", "step mode", "event mode",
                                      "continuous-time mode", "terminated", "failed"};
  int index = 0;
  if (instance->image.phase & phases) return true;
  while (index < 6 && !(instance->image.phase >> index & 1)) index++;
  fb_say(instance, FB_ERROR, "%s is not allowed in state '%s'", function, names[index]);
  return false;
}

bool fb_given(fb_instance *instance, const char *function, const char *argument, const void *pointer, size_t count) {
  if (pointer || count == 0) return true;
  fb_say(instance, FB_ERROR, "%s: the argument '%s' is NULL", function, argument);
  return false;
}

bool fb_listen(fb_instance *instance, bool on, size_t count, const char *const *categories) {
  bool known = true;
  size_t i;
  int level;
  if (count == 0) instance->levels = on ? ~0 : 0;
  for (i = 0; i < count; i++) {
    for (level = 0; level < 4; level++)
      if (categories[i] && strcmp(categories[i], fb_categories[level]) == 0) break;
    if (level < 4)
      instance->levels = on ? instance->levels | 1 << level : instance->levels & ~(1 << level);
    else {
      known = false;
      fb_say(instance, FB_WARNING, "there is no log category '%s'", categories[i] ? categories[i] : "");
    }
  }
  return known;
}
