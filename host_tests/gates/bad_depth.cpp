// Takes more stack than there is: the stack gate must refuse it.
extern "C" int main();

int main() {
  volatile char bad_depth[9000];
  for (volatile char& byte : bad_depth) {
    byte = 1;
  }
  return bad_depth[1];
}
