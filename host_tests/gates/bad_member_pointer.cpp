// A function calls itself through a pointer to a member that has the name of another function: the
// stack gate must refuse it.
extern "C" int main();

namespace {

class Other {
 public:
  constexpr Other() noexcept = default;
  Other(const Other&) = delete;
  Other& operator=(const Other&) = delete;
  virtual int take(int count) noexcept;

 protected:
  ~Other() = default;
};

class Step {
 public:
  using Member = int (Step::*)(int) noexcept;

  constexpr Step() noexcept = default;
  Step(const Step&) = delete;
  Step& operator=(const Step&) = delete;
  virtual int again(int count) noexcept;

 protected:
  ~Step() = default;
};

class BadOther final : public Other {};
class BadStep final : public Step {};

int Other::take(int count) noexcept { return count; }
int Step::again(int count) noexcept {
  // Whatever it holds by then.
  Member take = &Step::again;
  asm volatile("" : "+m"(take));
  return count == 0 ? 0 : (this->*take)(count - 1) + count;
}

BadOther other;
BadStep bad;
Other* volatile first = &other;
Step* volatile second = &bad;
volatile int count = 3;

}  // namespace

int main() { return first->take(count) + second->again(count); }
