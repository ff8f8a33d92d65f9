#pragma once

namespace palpate::study {

/// Words that no report, table or text of an analysis may contain: nobody chooses a level afterwards.
inline constexpr const char* kForbiddenWords[] = {"best level",    "best noise",    "best share",
                                                  "optimal level", "optimum level", "optimal noise",
                                                  "optimum noise", "optimal share", "best condition"};

}  // namespace palpate::study
