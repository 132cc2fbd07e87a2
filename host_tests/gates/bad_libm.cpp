// Takes the exponential from libm, whose digits differ between systems: the symbol gate must refuse
// it.
extern "C" double exp(double x);
double bad_libm(double x) { return exp(x); }
