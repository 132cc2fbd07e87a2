// Throws: the symbol gate must refuse it.
void bad_exception(int x) {
  if (x < 0) {
    throw x;
  }
}
