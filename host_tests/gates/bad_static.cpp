// Initialises a function-local static at its first use: the symbol gate must refuse it.
int bad_static(int x) {
  static const int first = x;
  return first;
}
