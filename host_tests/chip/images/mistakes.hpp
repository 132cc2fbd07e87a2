// The list of wrong uses, for the image that makes them and the test that expects to find them.
#pragma once

/// Calls a macro with each name. Nearly every one is the name of the finding, too.
#define EMAX_CHIP_MISTAKES(row)                                                                      \
  row(nothing) row(clock_off) row(clock_enable_not_read_back) row(reserved_bit_written) row(         \
      no_such_register) row(wrong_width) row(read_only_register_written) row(held_in_reset)          \
      row(pll_changed_while_on) row(pll_without_source) row(vco_out_of_range) row(                   \
          pll_input_out_of_range) row(too_few_wait_states) row(too_fast_for_voltage)                 \
          row(clock_step_too_big) row(switch_to_dead_clock) row(pll_output_off) row(                 \
              clock_source_switched_off) row(uart_baud_rate) row(uart_setting_while_enabled)         \
              row(uart_transmitter_off) row(uart_data_overwritten) row(                              \
                  uart_pin_not_connected) row(watchdog_locked) row(watchdog_updating)                \
                  row(watchdog_wrong_key) row(adc_regulator_too_soon) row(adc_regulator_off) row(    \
                      adc_not_calibrated) row(adc_calibration_while_enabled)                         \
                      row(adc_calibration_with_dma) row(adc_busy_calibrating) row(                   \
                          adc_start_before_ready) row(adc_slave_not_ready) row(adc_no_clock)         \
                          row(adc_too_fast) row(adc_same_channel) row(adc_pair_differs) row(         \
                              adc_channel_not_connected) row(adc_pin_not_analog)                     \
                              row(adc_trigger_during_conversion) row(                                \
                                  adc_oversampling_overflow) row(adc_setting_while_started)          \
                                  row(adc_common_while_enabled) row(adc_dma_one_shot) row(           \
                                      adc_overrun) row(dma_not_circular) row(dma_no_request_chosen)  \
                                      row(dma_nothing_to_transfer) row(dma_unreachable) row(         \
                                          dma_misaligned) row(dma_setting_while_enabled)             \
                                          row(dac_hfsel) row(dac_mode_while_enabled) row(            \
                                              dac_output_before_first_trigger)                       \
                                              row(dac_pin_not_analog) row(dac_underrun) row(         \
                                                  dac_by_half_words) row(flash_wrong_key)            \
                                                  row(flash_locked) row(                             \
                                                      flash_old_error_flags) row(flash_not_erased)   \
                                                      row(flash_word_order) row(                     \
                                                          flash_data_cache_on) row(flash_own_bank)   \
                                                          row(flash_nothing_to_erase) row(           \
                                                              flash_not_programming) row(flash_busy) \
                                                              row(option_bytes_written) row(         \
                                                                  cache_reset_while_on)              \
                                                                  row(fpu_off) row(                  \
                                                                      interrupt_without_handler)     \
                                                                      row(flag_not_cleared) row(     \
                                                                          vectors_misaligned)        \
                                                                          row(trace_off)             \
                                                                              row(bad_read) row(     \
                                                                                  not_modelled)
