#include "Applications/CommandLine.h"
#include "Applications/Elastic.h"
#include "Applications/Evaluate.h"
#include "Applications/Info.h"
#include "Applications/Phantom.h"
#include "Applications/Register.h"
#include "Applications/Version.h"
#include "Applications/Warp.h"

int main(int argc, char** argv) {
  const std::vector<crease::Subcommand> subcommands = {
      crease::register_subcommand(), crease::elastic_subcommand(), crease::warp_subcommand(),
      crease::info_subcommand(),     crease::phantom_subcommand(), crease::evaluate_subcommand()};
  return crease::run_command(argc, argv, subcommands, crease::version_text());
}
