"""How much memory a process of its own has taken at most."""

PRINT_PEAK = """
import pathlib, re, resource
status = pathlib.Path("/proc/self/status")
if status.exists():  # getrusage tells the peak of whoever started the process, if that was larger
    print(int(re.search(r"VmHWM:\\s*(\\d+) kB", status.read_text())[1]) * 1024)
else:
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""
"""A program's last lines: they print its peak resident memory, bytes."""
