"""The faults of boards, one row each."""

from typing import Final

from emulators.bench.faults import board
from emulators.bench.faults.kind import FaultKind

BOARD_ROWS: Final = (
    FaultKind(
        board.BoardSilent,
        "The board's USB cable is out, or its second chip hangs; the sketch lives on.",
        "A board: ros_arduino_bridge stops its motors when it has received nothing for its time, the other"
        " firmwares let them run on with the last command. Interlock: `axis timeout`.",
        "the board's line",
    ),
    FaultKind(
        board.BoardReset,
        "Someone presses the board's button, or its supply has a dip. An instant: no end.",
        "A board: receives nothing for the boot loader's 1.1 s, or until 9 s after the last byte where one"
        " comes in that time, while the shield goes on as commanded; then those of"
        " ros_arduino_bridge and ArduinoIO release their motors; the others run on until they are set up.",
    ),
    FaultKind(
        board.BoardBrownOut,
        "The 5 V of the board's processor sag, as with a long USB cable: the brown-out detection holds it in"
        " reset. The shield has its own supply, and its chip lives on down to 2.3 V.",
        "A board: receives nothing, while the shield goes on as commanded; with the supply it restarts, as"
        " after `board_reset`.",
        "the board's supply",
    ),
    FaultKind(
        board.BoardUnpowered,
        "The board's 5 V are gone, which shield and processor have in common; the motors' own supply stays.",
        "A board: silent, its motors roll out; with the supply both start again, as after `board_reset`.",
        "the board's supply",
    ),
    FaultKind(
        board.CurrentLimit,
        "A half bridge cuts a current that reaches 3.2 A, by the data sheet; without it a motor has all"
        " that it takes.",
        "A board: notices nothing; a wheel that is held pushes less.",
    ),
    FaultKind(
        board.OverTemperature,
        "The half bridges are followed as they warm up, from 25 degrees C on, and shut down at 175.",
        "A board: notices nothing; the motors of a chip that shut down roll out until it has cooled.",
    ),
    FaultKind(
        board.BoardChatters,
        "The sketch prints something by itself, as a debug print that was left in, or an analog report that a"
        " stray byte has switched on.",
        "A board: lives on as it was, and obeys. The bridge takes what answers no question for nothing.",
    ),
    FaultKind(
        board.ShieldAbsent,
        "No shield is on the board, or it has no power: the I2C bus has no pull-ups, and AFMS.begin() waits"
        " for ever. The motors are without power.",
        "A board: as with `board_hangs`, from its next word to the shield on, and after each reset from"
        " AFMS.begin() on: ros_arduino_bridge and ArduinoIO hang in setup(), and answer nothing.",
        "the shield",
    ),
    FaultKind(
        board.I2cStuck,
        "A line of the I2C bus is held low: by a chip that was cut off in the middle of a byte, by a wire.",
        "A board: hangs at its next word to the shield, which goes on as it was set; no reset of the board"
        " frees it. The bridge goes through its steps and reports that the wheels may turn.",
        "the shield",
    ),
    FaultKind(
        board.LineGarbage,
        "A disturbance on the line between bridge and board: bytes that no one has sent, to both of them,"
        " in the middle of what they say.",
        "A board: reads them as its firmware reads anything. MWProtocol alone has a checksum; with ArduinoIO"
        " a byte may become the speed of a motor.",
    ),
    FaultKind(
        board.BoardHangs,
        "The firmware does nothing more until a reset: Wire waits for ever where the I2C bus is stuck. An"
        " instant: no end.",
        "A board: as with `board_silent`, but the auto-stop hangs, too, and a reset frees it.",
    ),
    FaultKind(
        board.ShaftBlocked,
        "Something holds what the motor turns: a cable, a threshold, a hand. The others push on.",
        "A board: notices nothing; a loop of speeds on it drives harder and harder. Interlocks:"
        " `position not changing` and `tracking error`.",
        "the shaft",
    ),
    FaultKind(
        board.LoadLifted,
        "A light base stands on what is uneven, or someone picks it up: what the motor turns is in the air,"
        " and spins free.",
        "A board: notices nothing, its encoder counts on. The base goes otherwise than its motors turn: where"
        " cameras see it: interlock `base slips`; without them odometry is wrong, and no one knows.",
        "the load",
    ),
    FaultKind(
        board.MotorSupplySag,
        "The motors' own supply sags, as a battery that is empty; the processor lives on its own. Below 2.5 V"
        " the half bridges lock their outputs, and from 2.8 V on they work again.",
        "A board: notices nothing; a loop of speeds on it drives harder and harder. Interlock:"
        " `tracking error`.",
        "the motors' supply",
    ),
    FaultKind(
        board.MotorCableOff,
        "A wire between shield and motor is off: the motor rolls out.",
        "A board: notices nothing. Interlock: `tracking error`.",
        "the motor's cable",
    ),
    FaultKind(
        board.MotorLeadsSwapped,
        "The two leads of a motor are exchanged: it turns the other way than commanded, and its encoder"
        " reports so.",
        "A board: notices nothing; a loop of speeds drives it at full speed the wrong way. Interlock:"
        " `uncommanded motion`.",
        "the motor's leads",
    ),
    FaultKind(
        board.EncoderCableOff,
        "The cable of a motor's encoder is off: no edge comes any more, the motor turns on.",
        "A board: its loop drives harder and harder. Interlock: `position not changing`.",
        "the encoder's cable",
    ),
)
