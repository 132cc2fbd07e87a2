// The options of settings, made from their rows.
#pragma once

#include <string_view>
#include <vector>

#include "emax/app/settings/settings.hpp"
#include "emax/app/settings/sweep_settings.hpp"

#include "desk/cli/option.hpp"

namespace emax::desk {

/// Heading of all options of the simulated bench and its sweep.
inline constexpr const char kBenchHeading[] =
    "The simulated bench, which measures without --points and --model";

/// @returns The options of the rows of kSettingRows, in their order. They write to `settings`,
/// which has to outlive them. Lists have nobody to take them yet.
std::vector<Option> setting_options(app::Settings& settings);

/// @returns The same of kSweepSettingRows; of all that a sweep has, those that are options.
std::vector<Option> sweep_setting_options(app::SweepSettings& settings);

/// @returns The option that sets this, by the name that errors have for it; the same name if there
/// is none.
std::string_view option_of_setting(std::string_view setting) noexcept;

}  // namespace emax::desk
