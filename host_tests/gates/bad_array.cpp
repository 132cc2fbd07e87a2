// Has an array on the stack that is as long as the program decides: the stack gate must refuse it.
extern "C" int main();

namespace {

volatile int length = 100;

}  // namespace

int main() {
  const int count = length;
  auto* const bad_array =
      static_cast<volatile char*>(__builtin_alloca(static_cast<unsigned>(count)));
  for (int i = 0; i < count; ++i) {
    bad_array[i] = static_cast<char>(i);
  }
  return bad_array[count / 2];
}
