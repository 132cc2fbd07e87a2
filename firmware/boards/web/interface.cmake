# What the two modules have in common with the page: functions that it calls, and functions that it offers.

set(EMAX_WEB_EXPORTS emax_list_commands emax_poll emax_set_pace emax_start emax_store_bytes)
set(EMAX_WEB_IMPORTS now_us read store_read store_write take_break write)
set(EMAX_WEB_DESK_EXPORTS emax_answer emax_answer_size emax_answer_text emax_request)
