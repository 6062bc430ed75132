// fontconfig keeps its caches until the process ends, which the leak checker of a sanitizer build
// takes for leaks.
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig"; }
