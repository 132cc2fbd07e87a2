// Keeps a variable for each thread: the symbol gate must refuse it.
thread_local int bad_thread_local = 1;
