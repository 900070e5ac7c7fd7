--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body NXT.USB_Descriptors with SPARK_Mode is

   Device_To_Host    : constant Byte := 16#80#;
   Host_To_Device    : constant Byte := 16#00#;
   Host_To_Interface : constant Byte := 16#01#;
   Host_To_Endpoint  : constant Byte := 16#02#;
   Recipient         : constant Byte := 16#1F#;

   Status_Code             : constant Byte := 0;
   Clear_Feature_Code      : constant Byte := 1;
   Address_Code            : constant Byte := 5;
   Descriptor_Code         : constant Byte := 6;
   Configuration_Code      : constant Byte := 8;
   New_Configuration_Code  : constant Byte := 9;
   Interface_Code          : constant Byte := 11;

   function Descriptor_Kind (Item : Request) return Request_Kind is
      Class : constant Byte := Item (Value_Low + 1);
      Index : constant Byte := Item (Value_Low);
   begin
      return
        (case Class is
            when 1      => Get_Device,
            when 2      => Get_Configuration_Descriptor,
            when 3      =>
              (case Index is
                  when 0            => Get_Languages,
                  when Serial_Index => Get_Serial,
                  when others       => Unknown),
            when others => Unknown);
   end Descriptor_Kind;

   function From_Device (Item : Request) return Request_Kind is
     (case Item (2) is
         when Status_Code        => Get_Status,
         when Descriptor_Code    => Descriptor_Kind (Item),
         when Configuration_Code => Get_Configuration,
         when others             => Unknown);

   function To_Device (Item : Request) return Request_Kind is
     (case Item (2) is
         when Address_Code           => Set_Address,
         when New_Configuration_Code => Set_Configuration,
         when others                 => Unknown);

   function Kind_Of (Item : Request) return Request_Kind is
     (case Item (1) is
         when Device_To_Host    => From_Device (Item),
         when Host_To_Device    => To_Device (Item),
         when Host_To_Interface => (if Item (2) = Interface_Code then Accepted else Unknown),
         when Host_To_Endpoint  => (if Item (2) = Clear_Feature_Code then Accepted else Unknown),
         when others            =>
           (if (Item (1) and not Recipient) = Device_To_Host and then Item (2) = Status_Code
            then Get_Status else Unknown));

   function Text_Descriptor (Text : String) return Byte_Array is
   begin
      return Result : Byte_Array (1 .. 2 + 2 * Text'Length) := (others => 0) do
         Result (1) := Byte (Result'Length);
         Result (2) := 3;
         for Index in Text'Range loop
            Result (3 + 2 * (Index - Text'First)) := Character'Pos (Text (Index));
         end loop;
      end return;
   end Text_Descriptor;

end NXT.USB_Descriptors;
