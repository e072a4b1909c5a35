"""The arm AR2: equations, parameters and reference trajectory of six joints on stepper motors."""
