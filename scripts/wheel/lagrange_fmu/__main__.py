"""Run the command lagrange-fmu; its modules are imported while a handler of interrupts is set."""

import os
import signal


def main():
    handler = signal.getsignal(signal.SIGINT)
    if handler is signal.default_int_handler:
        signal.signal(signal.SIGINT, lambda *received: os._exit(130))  # KeyboardInterrupt during imports may be swallowed or replaced by another exception
    from .command import main

    signal.signal(signal.SIGINT, handler)
    main()


if __name__ == "__main__":
    main()
