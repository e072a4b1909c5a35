/* FMI 3.0 functions that a plant has no use for; each exists, and says so when it is called. */

#include "fmi3_shell.h"

#define REFERENCES const fmi3ValueReference references[], size_t count

static fmi3Status absent(fmi3Instance instance, const char *function, size_t count) {
  if (count == 0) return fmi3OK;
  if (instance) fb_allowed(instance, function, 0);
  return fmi3Error;
}

#define ABSENT(name, ...)                                                      \
  fmi3Status name(fmi3Instance instance, __VA_ARGS__) { return absent(instance, #name, 1); }
#define ABSENT_MODE(name)                                                      \
  fmi3Status name(fmi3Instance instance) { return absent(instance, #name, 1); }

#define TYPE(type)                                                             \
  fmi3Status fmi3Get##type(fmi3Instance instance, REFERENCES, fmi3##type values[], size_t n) {       \
    (void)references, (void)values, (void)n;                                   \
    return absent(instance, "fmi3Get" #type, count);                           \
  }                                                                            \
  fmi3Status fmi3Set##type(fmi3Instance instance, REFERENCES, const fmi3##type values[], size_t n) { \
    (void)references, (void)values, (void)n;                                   \
    return absent(instance, "fmi3Set" #type, count);                           \
  }

TYPE(Float32)
TYPE(Int8)
TYPE(UInt8)
TYPE(Int16)
TYPE(UInt16)
TYPE(Int32)
TYPE(UInt32)
TYPE(Int64)
TYPE(UInt64)
TYPE(Boolean)
TYPE(String)

ABSENT(fmi3GetBinary, REFERENCES, size_t sizes[], fmi3Binary values[], size_t n)
ABSENT(fmi3SetBinary, REFERENCES, const size_t sizes[], const fmi3Binary values[], size_t n)
ABSENT(fmi3GetClock, REFERENCES, fmi3Clock values[])
ABSENT(fmi3SetClock, REFERENCES, const fmi3Clock values[])
ABSENT(fmi3GetNumberOfVariableDependencies, fmi3ValueReference reference, size_t *n)
ABSENT(fmi3GetVariableDependencies, fmi3ValueReference dependent, size_t elements[],
       fmi3ValueReference independents[], size_t of[], fmi3DependencyKind kinds[], size_t n)
ABSENT(fmi3GetAdjointDerivative, REFERENCES, const fmi3ValueReference knowns[], size_t known,
       const fmi3Float64 seed[], size_t seeds, fmi3Float64 sensitivity[], size_t n)
ABSENT_MODE(fmi3EnterConfigurationMode)
ABSENT_MODE(fmi3ExitConfigurationMode)
ABSENT(fmi3GetIntervalDecimal, REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
ABSENT(fmi3GetIntervalFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
       fmi3IntervalQualifier qualifiers[])
ABSENT(fmi3GetShiftDecimal, REFERENCES, fmi3Float64 shifts[])
ABSENT(fmi3GetShiftFraction, REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
ABSENT(fmi3SetIntervalDecimal, REFERENCES, const fmi3Float64 intervals[])
ABSENT(fmi3SetIntervalFraction, REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
ABSENT(fmi3SetShiftDecimal, REFERENCES, const fmi3Float64 shifts[])
ABSENT(fmi3SetShiftFraction, REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
ABSENT_MODE(fmi3EnterStepMode)
ABSENT_MODE(fmi3EvaluateDiscreteStates)
ABSENT(fmi3GetOutputDerivatives, REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[], size_t n)
ABSENT(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)update, (void)lock;
  (void)unlock;
  if (log) log(environment, fmi3Error, "logStatusError", "scheduled execution is not offered, co-simulation is");
  return NULL;
}
