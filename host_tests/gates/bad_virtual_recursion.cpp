// A function calls itself by way of a vtable: the stack gate must refuse it.
extern "C" int main();

namespace {

class Step {
 public:
  Step(const Step&) = delete;
  Step& operator=(const Step&) = delete;
  virtual int take(int count) noexcept = 0;

 protected:
  constexpr Step() noexcept = default;
  ~Step() = default;
};

class LastStep final : public Step {
 public:
  constexpr LastStep() noexcept = default;
  int take(int count) noexcept override { return count; }
};

class BadStep final : public Step {
 public:
  constexpr explicit BadStep(Step*& next) noexcept : next_(next) {}
  int take(int count) noexcept override { return count == 0 ? 0 : next_->take(count - 1) + count; }

 private:
  Step*& next_;
};

LastStep last;
Step* volatile first = &last;
Step* next = &last;
BadStep bad(next);
volatile int count = 3;

}  // namespace

int main() {
  next = count > 2 ? static_cast<Step*>(&bad) : &last;
  first = next;
  return first->take(count);
}
