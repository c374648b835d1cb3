// A shared library that is not a plug-in: it registers nothing.
extern "C" int simvis_test_no_types() { return 0; }
