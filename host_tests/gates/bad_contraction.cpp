// Is compiled with contraction on: the contraction gate must refuse it. In single precision, too,
// for cores that multiply double in software.
double bad_contraction(double a, double b, double c) { return a * b + c; }
float bad_contraction(float a, float b, float c) { return a * b + c; }
