// Messages of the Vulkan validation layers. Any of them fails the test program that printed it and names the test case,
// so no test case looks for them itself.
#pragma once

namespace simvis::test {

/// The rest of this test case makes a mistake on purpose, whose message does not fail it.
void expect_validation_message();

}  // namespace simvis::test
