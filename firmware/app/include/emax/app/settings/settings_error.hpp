// What a check of settings found wrong.
#pragma once

namespace emax::app {

/// Which setting is wrong, and in words what it must be. Both are null if all is well.
struct SettingsError {
  const char* setting = nullptr;      ///< Its name: "time", "drive limit".
  const char* expectation = nullptr;  ///< "more than 0 and at most 1000 s".
};

}  // namespace emax::app
