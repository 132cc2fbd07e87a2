// What a command's handler sees: its parameters, its answer, and where to report what is wrong.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/app/scpi/error_code.hpp"
#include "emax/app/scpi/response.hpp"
#include "emax/app/scpi/status_model.hpp"
#include "emax/base/span.hpp"

namespace emax::app::scpi {

/// Units of numbers. Multipliers (EX PE T G MA K M U N P F A) may stand before them; MHZ is mega.
/// A quotient may be written as a product, too: "M.S-2" for "M/S2" (IEEE 488.2, 7.7.3).
inline constexpr const char kHertz[] = "HZ";
inline constexpr const char kSecond[] = "S";
inline constexpr const char kVolt[] = "V";
inline constexpr const char kMetrePerSecondSquared[] = "M/S2";
inline constexpr const char kPercent[] = "PCT";
inline constexpr const char kDegree[] = "DEG";

/// What a number may be. MINimum, MAXimum and DEFault stand for the three values.
struct NumberRule {
  double min = 0.0;
  double max = 0.0;
  double by_default = 0.0;     ///< A NaN: there is none, and the word DEFault is refused.
  const char* unit = nullptr;  ///< Null: a unit is refused.
};

/// The same for whole numbers; others are rounded to the nearest, halves away from zero.
struct IntegerRule {
  std::int64_t min = 0;
  std::int64_t max = 0;
  std::int64_t by_default = 0;
};

/// Words in the notation of patterns: {"ISE", "DIFFerence"}.
using Words = Span<const char* const>;

/// A number, or one of some words.
struct NumberOrWord {
  double number = 0.0;
  std::size_t word = 0;  ///< Its index; the number of words if it is a number.
};

/// One execution of a program message unit. Lives while the handler runs.
///
/// A handler takes its parameters in order. Before it is called, their number was checked against
/// the row's documentation, so optional ones are asked for by `has_more()`. Each call that takes a
/// parameter reports what is wrong with it, with the offending text, and answers false; the
/// handler then returns without a change. What a query answered is dropped if it reports an error.
///
/// Stages: a handler is called with kStart. If it calls `wait()`, it is called again, with kAgain
/// and the same parameters, until it does not: queries that are still being computed, *WAI, *OPC?.
/// If it calls `answer_items(n)`, it is called n more times, with kItem and `item()` = 0 to n - 1,
/// as fast as the answer is read: answers longer than `Response::kAnswerRoom`. Items may take
/// their parameters again.
class Call {
 public:
  enum class Stage : std::uint8_t { kStart, kAgain, kItem };

  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  bool is_query() const noexcept { return origin_.is_query; }
  Stage stage() const noexcept { return origin_.stage; }
  std::size_t item() const noexcept { return origin_.item; }
  /// @returns True if the command overtakes others that wait: `wait()` and `answer_items()` are
  /// errors there.
  bool is_overtaking() const noexcept { return origin_.is_overtaking; }

  /// @returns True if there is a parameter that was not taken.
  bool has_more() const noexcept { return count_ > 0; }
  /// @returns The number of parameters not taken.
  std::size_t count() const noexcept { return count_; }

  /// @returns Whether the next parameter begins with a letter, as MINimum does.
  bool has_word() const noexcept;

  /// A number with its unit, MINimum, MAXimum, DEFault, INFinity, NINFinity or NAN (9.9E37 and
  /// 9.91E37 are infinity and NaN), or #H, #Q, #B. What is outside the rule is -222.
  ///
  /// @returns False, with `value` unchanged, if an error was reported.
  bool number(const NumberRule& rule, double& value) noexcept;
  bool integer(const IntegerRule& rule, std::int64_t& value) noexcept;
  /// ON, OFF or a number: true unless it rounds to 0.
  bool boolean(bool& value) noexcept;
  /// @param[out] index Of the word given.
  bool choice(Words words, std::size_t& index) noexcept;
  /// All parameters that are left; none is fine.
  ///
  /// @param[out] values Filled from its front; undefined after an error.
  /// @param[out] count  How many there were.
  /// @returns False after an error; -223 if there are more than fit.
  bool numbers(const NumberRule& rule, Span<double> values, std::size_t& count) noexcept;
  /// The text of a string without its quotes, doubled ones still doubled: a view of the input.
  bool string(Span<const char>& text) noexcept;

  /// A setting with both forms: a query is answered with `current` (or, where the row has
  /// kQueryLimits and MIN, MAX or DEF was given, with that); otherwise the new value is read.
  ///
  /// @returns True if there is a new value to be stored.
  bool setting(const NumberRule& rule, double current, double& value) noexcept;
  bool integer_setting(const IntegerRule& rule, std::int64_t current, std::int64_t& value) noexcept;
  bool boolean_setting(bool current, bool& value) noexcept;
  /// Answers the short form of the word.
  bool choice_setting(Words words, std::size_t current, std::size_t& index) noexcept;
  /// A number, or one of some words, of which the first is the default.
  bool number_or_word_setting(const NumberRule& rule, Words words, const NumberOrWord& current,
                              NumberOrWord& value) noexcept;

  /// The fields of the answer.
  Response& answer() noexcept { return response_; }
  /// Asks to be called again for each of the items, after what was answered so far.
  void answer_items(std::size_t count) noexcept;

  /// Reports an error.
  ///
  /// @param[in] words   What to do; kept by their address. May be null.
  /// @param[in] subject What they are about; may be null.
  void fail(ErrorCode code, const char* words = nullptr, const char* subject = nullptr) noexcept;
  /// The same with the offending text.
  void fail(ErrorCode code, Span<const char> offender) noexcept;
  bool failed() const noexcept { return failed_; }

  /// Asks to be called again later; nothing may have been answered yet.
  void wait() noexcept { waits_ = true; }

  StatusModel& status() noexcept { return status_; }
  /// @returns Whether an answer waits to be read, for `*STB?`.
  bool message_available() const noexcept { return origin_.message_available; }

 private:
  friend class Session;

  /// Why the handler is called.
  struct Origin {
    Stage stage = Stage::kStart;
    std::size_t item = 0;
    std::size_t count = 0;  ///< Of parameters.
    bool is_query = false;
    bool is_overtaking = false;
    bool message_available = false;
  };

  Call(StatusModel& status, Response& response, Span<const char> parameters,
       const Origin& origin) noexcept
      : status_(status),
        response_(response),
        rest_(parameters),
        count_(origin.count),
        origin_(origin) {}

  void note_failure(ErrorCode code) noexcept;
  bool take(Span<const char>& text) noexcept;
  bool refuse(Span<const char> text, ErrorCode error) noexcept;
  bool read_number(const NumberRule& rule, Span<const char> text, double& value) noexcept;
  bool read_in_range(const NumberRule& rule, Span<const char> text, double& value) noexcept;
  bool read_word_number(const NumberRule& rule, Span<const char> text, double& value) noexcept;
  bool read_choice(Words words, Span<const char> text, std::size_t& index) noexcept;
  bool take_limit(const NumberRule& rule, double& value) noexcept;

  StatusModel& status_;
  Response& response_;
  Span<const char> rest_;  ///< From the next parameter on.
  std::size_t count_;      ///< Parameters in it.
  Origin origin_;
  std::size_t items_ = 0;
  bool failed_ = false;
  bool stops_message_ = false;
  bool waits_ = false;
};

}  // namespace emax::app::scpi
