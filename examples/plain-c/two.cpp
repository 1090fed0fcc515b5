// Two controllers in one C++ program, each with its own copy of the Rust runtime. One of them is saved and restored.
//
//     cargo xtask c dob polish
//     c++ -I target/c/fmu-dob -I target/c/fmu-polish examples/plain-c/two.cpp target/c/fmu-dob/libfmu_dob.a
//         target/c/fmu-polish/libfmu_polish.a -o two && ./two
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>
#include "fmu_dob.h"
#include "fmu_polish.h"

namespace {

template <typename T, void (*release)(T *)>
struct Freed {
    void operator()(T *controller) const { release(controller); }
};
using Dob = std::unique_ptr<fmu_dob, Freed<fmu_dob, fmu_dob_free>>;
using Polish = std::unique_ptr<fmu_polish, Freed<fmu_polish, fmu_polish_free>>;

// keeps the last message of a controller: the reason of a rejection
void keep(void *user, int, const char *text) { *static_cast<std::string *>(user) = text; }

template <typename T>
T made(T controller, const std::string &reason) {
    if (!controller) throw std::runtime_error(reason);
    return controller;
}

void check(bool good, const std::string &reason) {
    if (!good) throw std::runtime_error(reason);
}

}  // namespace

int main() try {
    std::string message;
    fmu_dob_parameters slide;
    fmu_dob_start_parameters(&slide);
    const Dob dob = made(Dob(fmu_dob_new(&slide, nullptr, keep, &message)), message);
    fmu_polish_parameters robot;
    fmu_polish_start_parameters(&robot);
    robot.force.target = 8.0;
    const Polish polish = made(Polish(fmu_polish_new(&robot, nullptr, keep, &message)), message);

    fmu_dob_inputs from_slide;
    fmu_dob_start_inputs(&from_slide);
    fmu_dob_outputs to_slide;
    fmu_polish_inputs from_robot;
    fmu_polish_start_inputs(&from_robot);
    fmu_polish_outputs to_robot;
    for (int k = 0; k < 1000; k++) {
        from_slide.position = 1e-8 * (k % 7);
        check(fmu_dob_step(dob.get(), &from_slide, &to_slide), message);
        check(fmu_polish_step(polish.get(), &from_robot, &to_robot), message);
    }

    std::vector<unsigned char> state(fmu_dob_save(dob.get(), nullptr, 0));
    check(!state.empty() && fmu_dob_save(dob.get(), state.data(), state.size()) == state.size(), message);
    fmu_dob_outputs once, again;
    check(fmu_dob_step(dob.get(), &from_slide, &once), message);
    check(fmu_dob_restore(dob.get(), state.data(), state.size()), message);
    check(fmu_dob_step(dob.get(), &from_slide, &again), message);
    std::printf("current %.17g A, and once more %.17g A\n", once.current, again.current);

    // a value out of its range is rejected by name
    slide.approach.velocity = 1.0;
    check(!fmu_dob_tune(dob.get(), &slide), "a wrong parameter was accepted");
    std::printf("rejected: %s\n", message.c_str());
    return once.current == again.current ? 0 : 1;
} catch (const std::exception &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
