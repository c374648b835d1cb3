// A shared library that is no plug-in: it registers nothing.
extern "C" int simvis_test_no_types() { return 0; }
