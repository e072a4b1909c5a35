/* States of an instance, saved and restored by copying; as bytes they carry the model's token in front, and a
   checksum behind. */

#include <stdlib.h>
#include <string.h>

#include "core.h"

typedef unsigned long long fb_sum;

/* FNV-1a of 64 bits: any byte that differs gives another one. */
static fb_sum checksum(const char *bytes, size_t size) {
  fb_sum sum = 14695981039346656037ULL;
  size_t i;
  for (i = 0; i < size; i++) sum = (sum ^ (unsigned char)bytes[i]) * 1099511628211ULL;
  return sum;
}

bool fb_save(fb_instance *instance, void **state) {
  if (!*state) *state = malloc(sizeof(fb_image));
  if (!*state) {
    fb_say(instance, FB_ERROR, "no memory for a saved state");
    return false;
  }
  memcpy(*state, &instance->image, sizeof(fb_image));
  return true;
}

bool fb_restore(fb_instance *instance, const void *state) {
  const fb_image *saved = state;
  if (!saved || saved->exchange != instance->image.exchange) {
    fb_say(instance, FB_ERROR, saved ? "the state was saved by an instance of the other interface"
                                     : "there is no saved state to restore");
    return false;
  }
  memcpy(&instance->image, saved, sizeof(fb_image));
  return true;
}

#define SUMMED (sizeof FB_TOKEN + sizeof(fb_image))

size_t fb_serial_size(void) { return SUMMED + sizeof(fb_sum); }

bool fb_serialise(fb_instance *instance, const void *state, char *bytes, size_t size) {
  fb_sum sum;
  if (!state || !bytes || size < fb_serial_size()) {
    fb_say(instance, FB_ERROR, "a saved state needs %u bytes", (unsigned)fb_serial_size());
    return false;
  }
  memcpy(bytes, FB_TOKEN, sizeof FB_TOKEN);
  memcpy(bytes + sizeof FB_TOKEN, state, sizeof(fb_image));
  sum = checksum(bytes, SUMMED);
  memcpy(bytes + SUMMED, &sum, sizeof sum);
  return true;
}

bool fb_deserialise(fb_instance *instance, const char *bytes, size_t size, void **state) {
  fb_sum sum;
  if (!bytes || size != fb_serial_size() || memcmp(bytes, FB_TOKEN, sizeof FB_TOKEN) != 0) {
    fb_say(instance, FB_ERROR, "these bytes are no saved state of this model and version");
    return false;
  }
  memcpy(&sum, bytes + SUMMED, sizeof sum);
  if (sum != checksum(bytes, SUMMED)) {
    fb_say(instance, FB_ERROR, "these bytes of a saved state have been changed: take the state again");
    return false;
  }
  if (!*state) *state = malloc(sizeof(fb_image));
  if (!*state) {
    fb_say(instance, FB_ERROR, "no memory for a saved state");
    return false;
  }
  memcpy(*state, bytes + sizeof FB_TOKEN, sizeof(fb_image));
  return true;
}
