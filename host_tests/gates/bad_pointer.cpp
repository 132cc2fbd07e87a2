// Calls whatever a pointer points at, and that is on no list: the stack gate must refuse it.
extern "C" int main();

namespace {

int bad_target() { return 1; }
int (*volatile bad_pointer)() = bad_target;

}  // namespace

int main() { return bad_pointer(); }
