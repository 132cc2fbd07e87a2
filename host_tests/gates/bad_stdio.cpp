// Prints through stdio: the symbol gate must refuse it.
extern "C" int printf(const char* format, ...);
void bad_stdio(double x) { printf("%g", x); }
