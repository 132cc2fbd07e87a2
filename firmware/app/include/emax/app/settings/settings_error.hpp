// What is wrong with a setting, in words.
#pragma once

namespace emax::app {

/// What `check()` found wrong: which setting, and in words what it must be.
struct SettingsError {
  const char* setting = nullptr;  ///< The option's name, "time" for instance; null if all is well.
  const char* expectation = nullptr;  ///< "more than 0 and at most 1000 s".
};

}  // namespace emax::app
