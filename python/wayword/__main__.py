"""The program `wayword`, as `python -m wayword` and as the script of that name."""

import signal
import sys


def main() -> int:
    """Runs the program with the arguments of this process. Returns its exit code."""
    from wayword import _wayword
    from wayword._guard import GUARDIAN

    # Wayword handles Ctrl-C itself. Python's own handler would raise KeyboardInterrupt after the end.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    _wayword.guarded_by(*GUARDIAN)
    return _wayword.main(["wayword", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
