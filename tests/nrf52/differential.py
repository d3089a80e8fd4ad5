"""Runs each instruction of its input in unicorn: lines of hexadecimal words in, lines of the same words out."""

import sys

from unicorn import UC_ARCH_ARM, UC_MODE_MCLASS, UC_MODE_THUMB, Uc, UcError, arm_const

CODE = 0x1000
# msr apsr_nzcvqg, r0: unicorn sets GE by an instruction alone.
SET_FLAGS = bytes.fromhex("80f3008c")


def machine():
    uc = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
    uc.ctl_set_cpu_model(arm_const.UC_CPU_ARM_CORTEX_M4)
    uc.mem_map(CODE, 0x1000)
    uc.reg_write(arm_const.UC_ARM_REG_FPEXC, 1 << 30)
    return uc


def names():
    general = [getattr(arm_const, f"UC_ARM_REG_R{number}") for number in range(13)]
    single = [getattr(arm_const, f"UC_ARM_REG_S{number}") for number in range(32)]
    return general + [arm_const.UC_ARM_REG_XPSR, arm_const.UC_ARM_REG_FPSCR] + single


def run(uc, code):
    uc.mem_write(CODE, code + b"\x00\xbf\x00\xbf")
    uc.ctl_remove_cache(CODE, CODE + 16)
    uc.emu_start(CODE | 1, CODE + len(code), count=1)


uc, registers = machine(), names()
for line in sys.stdin:
    code, *state = line.split()
    try:
        uc.reg_write(arm_const.UC_ARM_REG_R0, int(state[13], 16))
        run(uc, SET_FLAGS)
        for register, value in zip(registers, state):
            if register != arm_const.UC_ARM_REG_XPSR:
                uc.reg_write(register, int(value, 16))
        run(uc, bytes.fromhex(code))
        print(*(f"{uc.reg_read(register):x}" for register in registers))
    except UcError as error:
        print(error)
        uc = machine()
