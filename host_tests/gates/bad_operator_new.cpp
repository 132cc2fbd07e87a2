// A class with memory of its own for `new`: the symbol gate must refuse it.
namespace {

class BadOperatorNew {
 public:
  [[gnu::noipa]] static void* operator new(decltype(sizeof(0)) size) noexcept;

 private:
  int value_ = 1;
};

char memory[64];
decltype(sizeof(0)) used = 0;

void* BadOperatorNew::operator new(decltype(sizeof(0)) size) noexcept {
  used += size;
  return memory + used - size;
}

}  // namespace

const void* bad_operator_new();
const void* bad_operator_new() { return new BadOperatorNew(); }
