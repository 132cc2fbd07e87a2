// Two functions call one another: the stack gate must refuse it.
extern "C" int main();

namespace {

volatile int count = 3;

[[gnu::noinline]] int bad_recursion(int depth);

[[gnu::noinline]] int bad_detour(int depth) {
  return depth == 0 ? count : bad_recursion(depth - 1) + count;
}
[[gnu::noinline]] int bad_recursion(int depth) { return bad_detour(depth) + count; }

}  // namespace

int main() { return bad_recursion(count); }
