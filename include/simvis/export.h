// Which names of the headers the shared library exports.
#pragma once

/// Marks a class or a function of the public headers that libsimvis exports. All other names of the library are hidden.
/// What is inline needs no mark, except classes that are thrown, or derived from, across the library's border: every
/// side must see one type.
///
/// A class of a plug-in needs no mark, whatever visibility the plug-in is compiled with.
#define SIMVIS_API __attribute__((visibility("default")))
