function nxt_settings(model, period)
% SPDX-FileCopyrightText: 2026 Ravenbrick contributors
% SPDX-License-Identifier: Apache-2.0
%
% NXT_SETTINGS(MODEL, PERIOD) configures an open Simulink model for Embedded Coder, so that
% 'ravenbrick bind' takes its code. PERIOD is that of the Ada task that calls the step, in seconds:
%
%   load_system('functional'); nxt_settings('functional', 0.004); slbuild('functional');
%
% docs/guides/embedded-coder.md gives the reason for each setting.

% Target; it comes first, because it resets others
set_param(model, 'HardwareBoard', 'None');
set_param(model, 'SystemTargetFile', 'ert.tlc');
set_param(model, 'TargetLang', 'C');
set_param(model, 'TargetLangStandard', 'C99 (ISO)');
set_param(model, 'CodeReplacementLibrary', 'None');
set_param(model, 'GenCodeOnly', 'on');

% Processor
set_param(model, 'ProdHWDeviceType', 'ARM Compatible->ARM 7');
set_param(model, 'ProdEqTarget', 'on');
set_param(model, 'ProdLongLongMode', 'on');
set_param(model, 'ProdEndianess', 'LittleEndian');
set_param(model, 'ProdIntDivRoundTo', 'Zero');
set_param(model, 'ProdShiftRightIntArith', 'on');

% The device type fixes the word lengths; a release that knows others is refused here
expect(model, 'ProdBitPerChar', 8);
expect(model, 'ProdBitPerShort', 16);
expect(model, 'ProdBitPerInt', 32);
expect(model, 'ProdBitPerLong', 32);
expect(model, 'ProdBitPerLongLong', 64);
expect(model, 'ProdBitPerFloat', 32);
expect(model, 'ProdBitPerDouble', 64);
expect(model, 'ProdBitPerPointer', 32);
expect(model, 'ProdBitPerSizeT', 32);
expect(model, 'ProdBitPerPtrDiffT', 32);

% Time
set_param(model, 'SolverType', 'Fixed-step');
set_param(model, 'Solver', 'FixedStepDiscrete');
set_param(model, 'FixedStep', num2str(period, 17));
set_param(model, 'EnableMultiTasking', 'off');
set_param(model, 'SupportContinuousTime', 'off');
set_param(model, 'SupportAbsoluteTime', 'off');

% Numbers
set_param(model, 'DefaultUnderspecifiedDataType', 'single');
set_param(model, 'DefaultParameterBehavior', 'Tunable');
set_param(model, 'PurelyIntegerCode', 'off');
set_param(model, 'SupportNonFinite', 'off');
set_param(model, 'SupportComplex', 'off');
set_param(model, 'SupportVariableSizeSignals', 'off');
set_param(model, 'SupportNonInlinedSFcns', 'off');

% Entry points
set_param(model, 'CodeInterfacePackaging', 'Nonreusable function');
set_param(model, 'CombineOutputUpdateFcns', 'on');
set_param(model, 'IncludeMdlTerminateFcn', 'off');
set_param(model, 'SuppressErrorStatus', 'on');
set_param(model, 'GRTInterface', 'off');
set_param(model, 'MatFileLogging', 'off');
set_param(model, 'ExtMode', 'off');

% Files
set_param(model, 'ERTFilePackagingFormat', 'Compact');
set_param(model, 'UtilityFuncGeneration', 'Auto');
set_param(model, 'GenerateSampleERTMain', 'off');
set_param(model, 'EnableUserReplacementTypes', 'off');
end

function expect(model, name, bits)
found = get_param(model, name);
assert(found == bits, '%s is %d, but %d on the NXT: choose a custom processor', name, found, bits);
end
