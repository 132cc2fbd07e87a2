// Is compiled with contraction on: the contraction gate must refuse it.
double bad_contraction(double a, double b, double c) { return a * b + c; }
