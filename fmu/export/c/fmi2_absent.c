/* FMI 2.0 functions that a plant has no use for; each exists, and says so when it is called. */

#include "fmi2_shell.h"

#define REFERENCES const fmi2ValueReference references[], size_t count

static fmi2Status absent(fmi2Component component, const char *function, size_t count) {
  if (count == 0) return fmi2OK;
  if (component) fb_allowed(component, function, 0);
  return fmi2Error;
}

#define ABSENT(name, ...)                                                      \
  fmi2Status name(fmi2Component component, __VA_ARGS__) { return absent(component, #name, 1); }

#define TYPE(type)                                                             \
  fmi2Status fmi2Get##type(fmi2Component component, REFERENCES, fmi2##type values[]) {       \
    (void)references, (void)values;                                            \
    return absent(component, "fmi2Get" #type, count);                          \
  }                                                                            \
  fmi2Status fmi2Set##type(fmi2Component component, REFERENCES, const fmi2##type values[]) { \
    (void)references, (void)values;                                            \
    return absent(component, "fmi2Set" #type, count);                          \
  }

TYPE(Integer)
TYPE(Boolean)
TYPE(String)

ABSENT(fmi2SetRealInputDerivatives, REFERENCES, const fmi2Integer order[], const fmi2Real value[])
ABSENT(fmi2GetRealOutputDerivatives, REFERENCES, const fmi2Integer order[], fmi2Real value[])
fmi2Status fmi2CancelStep(fmi2Component component) { return absent(component, "fmi2CancelStep", 1); }
ABSENT(fmi2GetStatus, const fmi2StatusKind kind, fmi2Status *value)
ABSENT(fmi2GetRealStatus, const fmi2StatusKind kind, fmi2Real *value)
ABSENT(fmi2GetIntegerStatus, const fmi2StatusKind kind, fmi2Integer *value)
ABSENT(fmi2GetBooleanStatus, const fmi2StatusKind kind, fmi2Boolean *value)
ABSENT(fmi2GetStringStatus, const fmi2StatusKind kind, fmi2String *value)
