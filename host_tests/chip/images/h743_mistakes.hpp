// The list of wrong uses of the STM32H743, for the image that makes them and the test that expects
// to find them.
#pragma once

/// Calls a macro with each name. Nearly every one is the name of the finding, too.
#define EMAX_H743_MISTAKES(row)                                                                    \
  row(nothing) row(supply_not_set) row(supply_wrong) row(supply_set_twice) row(                    \
      too_fast_for_voltage) row(too_few_wait_states) row(flash_write_delay) row(hse_not_bypassed)  \
      row(pll_range_wrong) row(pll_input_out_of_range) row(vco_out_of_range) row(                  \
          pll_output_divider) row(pll_output_off) row(pll_changed_while_on)                        \
          row(overdrive_not_allowed) row(backup_domain_locked) row(memory_clock_off) row(          \
              clock_enable_not_read_back) row(cache_not_invalidated) row(dma_cacheable_memory)     \
              row(cached_with_protection) row(dma_unreachable) row(dma_memory_without_clock)       \
                  row(dma_packs) row(dma_memory_size_ignored) row(dma_burst_in_direct_mode) row(   \
                      dma_burst_and_threshold) row(dma_burst_misaligned)                           \
                      row(dma_count_not_multiple) row(dma_not_circular) row(dma_old_flags) row(    \
                          dma_without_trbuff) row(dma_setting_while_enabled)                       \
                          row(dma_no_request_chosen) row(adc_slave_may_slip) row(                  \
                              adc_channel_not_preselected) row(adc_boost) row(adc_not_linear)      \
                              row(adc_regulator_too_soon) row(adc_too_fast) row(                   \
                                  adc_trigger_during_conversion) row(adc_oversampling_overflow)    \
                                  row(adc_dma_one_shot) row(dac_by_half_words) row(                \
                                      dac_output_before_first_trigger) row(uart_baud_rate)         \
                                      row(watchdog_locked) row(trace_locked) row(                  \
                                          vectors_misaligned) row(flash_wrong_key)                 \
                                          row(flash_locked) row(flash_own_bank) row(               \
                                              flash_nothing_to_erase) row(flash_not_programming)   \
                                              row(flash_word_order) row(flash_word_twice)          \
                                                  row(flash_word_incomplete) row(flash_not_erased) \
                                                      row(flash_busy) row(flash_old_error_flags)   \
                                                          row(option_bytes_written)
