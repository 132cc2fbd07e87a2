// Computes a global before main: the symbol gate must refuse it.
int bad_source();
int bad_initialiser = bad_source();
int bad_source() {
  static volatile int source = 1;
  return source;
}
