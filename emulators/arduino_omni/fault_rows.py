"""The faults of boards, one row each."""

from typing import Final

from emulators.arduino_omni import bench_faults
from emulators.bench.faults.kind import FaultKind

BOARD_ROWS: Final = (
    FaultKind(
        bench_faults.BoardSilent,
        "The board's USB cable is out, or its USB chip hangs; the sketch keeps running.",
        "A board: ros_arduino_bridge stops its motors when it has received nothing for its time, the other"
        " firmwares keep them running with the last command. Interlock: `axis timeout`.",
        "the board's line",
    ),
    FaultKind(
        bench_faults.BoardReset,
        "The board's reset button is pressed, or its supply dips. Instantaneous: no end.",
        "A board: receives nothing for the boot loader's 1.1 s, or until 9 s after the last byte if one"
        " arrives in that time, while the shield continues as commanded; then ros_arduino_bridge and"
        " ArduinoIO release their motors; with the others the motors run until the board is set up.",
    ),
    FaultKind(
        bench_faults.BoardBrownOut,
        "The 5 V of the board's processor sag, as with a long USB cable: the brown-out detection holds it in"
        " reset. The shield has its own supply, and its chip works down to 2.3 V.",
        "A board: receives nothing, while the shield continues as commanded; with the supply it restarts, as"
        " after `board_reset`.",
        "the board's supply",
    ),
    FaultKind(
        bench_faults.BoardUnpowered,
        "The board's 5 V fail, which supply shield and processor; the motors' own supply stays.",
        "A board: silent, its motors coast; with the supply both start again, as after `board_reset`.",
        "the board's supply",
    ),
    FaultKind(
        bench_faults.CurrentLimit,
        "A half bridge cuts a current that reaches 3.2 A, by the data sheet; without this fault the"
        " motor's current is not limited.",
        "A board: detects nothing; a blocked wheel has less torque.",
    ),
    FaultKind(
        bench_faults.OverTemperature,
        "The half bridges' temperatures are simulated, from 25 degrees C on; they shut down at 175.",
        "A board: detects nothing; the motors of a chip that shut down coast until it has cooled.",
    ),
    FaultKind(
        bench_faults.BoardChatters,
        "The sketch prints something by itself, as a debug print that was left in, or an analog report that a"
        " stray byte has switched on.",
        "A board: keeps running, and obeys. The bridge ignores bytes that answer no request.",
    ),
    FaultKind(
        bench_faults.ShieldAbsent,
        "No shield is on the board, or it has no power: the I2C bus has no pull-ups, and AFMS.begin() waits"
        " without end. The motors are without power.",
        "A board: as with `board_hangs`, from its next access to the shield on, and after each reset from"
        " AFMS.begin() on: ros_arduino_bridge and ArduinoIO hang in setup(), and answer nothing.",
        "the shield",
    ),
    FaultKind(
        bench_faults.I2cStuck,
        "A line of the I2C bus is held low: by a chip that was cut off in the middle of a byte, by a wire.",
        "A board: hangs at its next access to the shield, which continues as it was set; no reset of the"
        " board frees it. The bridge tries its stop stages and reports that the wheels may turn.",
        "the shield",
    ),
    FaultKind(
        bench_faults.LineGarbage,
        "A disturbance on the line between bridge and board: bytes that neither has sent arrive at"
        " both, within their messages.",
        "A board: reads them as its firmware reads anything. MWProtocol alone has a checksum; with ArduinoIO"
        " a byte may become the speed of a motor.",
    ),
    FaultKind(
        bench_faults.BoardHangs,
        "The firmware does nothing more until a reset: Wire waits without end if the I2C bus is stuck."
        " Instantaneous: no end.",
        "A board: as with `board_silent`, but the auto-stop hangs, too, and a reset frees it.",
    ),
    FaultKind(
        bench_faults.ShaftBlocked,
        "The motor's load is blocked: by a cable, a threshold, a hand. The other motors keep driving.",
        "A board: detects nothing; a speed regulator on it increases its output. Interlocks:"
        " `position not changing` and `tracking error`.",
        "the shaft",
    ),
    FaultKind(
        bench_faults.LoadLifted,
        "A light base stands on uneven ground, or is picked up: the motor's load is off the floor, and turns"
        " freely.",
        "A board: detects nothing, its encoder counts on. The base does not move as its motors turn: with"
        " cameras, interlock `base slips`; without them odometry is wrong, undetected.",
        "the load",
    ),
    FaultKind(
        bench_faults.MotorSupplySag,
        "The motors' own supply sags, as with an empty battery; the processor has its own. Below 2.5 V the"
        " half bridges switch their outputs off, and from 2.8 V on they work again.",
        "A board: detects nothing; a speed regulator on it increases its output. Interlock:"
        " `tracking error`.",
        "the motors' supply",
    ),
    FaultKind(
        bench_faults.MotorCableOff,
        "A wire between shield and motor is off: the motor coasts.",
        "A board: detects nothing. Interlock: `tracking error`.",
        "the motor's cable",
    ),
    FaultKind(
        bench_faults.MotorLeadsSwapped,
        "The two leads of a motor are exchanged: it turns the other way than commanded, and its encoder"
        " reports so.",
        "A board: detects nothing; a speed regulator drives it at full speed the wrong way. Interlock:"
        " `uncommanded motion`.",
        "the motor's leads",
    ),
    FaultKind(
        bench_faults.EncoderCableOff,
        "The cable of a motor's encoder is off: no edge arrives any more, the motor keeps turning.",
        "A board: its speed regulator increases its output. Interlock: `position not changing`.",
        "the encoder's cable",
    ),
)
