--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names;
with Interfaces;               use Interfaces;
with NXT.Bytes;                use NXT.Bytes;
with NXT.Priorities;
with NXT.Registers.PIO;        use NXT.Registers, NXT.Registers.PIO;
with NXT.Registers.PMC;
with NXT.Registers.UDP;        use NXT.Registers.UDP;
with NXT.USB_Descriptors;      use NXT.USB_Descriptors;

package body NXT.USB is

   Device : Registers.UDP.Peripheral renames Registers.UDP.UDP;

   Control_Point : constant Endpoint := 0;
   From_Host     : constant Endpoint := 1;
   Into_Host     : constant Endpoint := 2;

   function Interrupt_Of (Point : Endpoint) return Word is (Bit (Natural (Point)));

   --  A write of a control register is in force a few clocks later; more reads than that
   Most_Reads : constant := 20;

   procedure Clear (Point : Endpoint; Flags : Word) is
   begin
      Device.UDP_CSR (Point) := (Device.UDP_CSR (Point) or Kept_By_Ones) and not Flags;
      for Attempt in 1 .. Most_Reads loop
         exit when not Has (Device.UDP_CSR (Point), Flags);
      end loop;
   end Clear;

   procedure Set (Point : Endpoint; Flags : Word) is
   begin
      Device.UDP_CSR (Point) := Device.UDP_CSR (Point) or Kept_By_Ones or Flags;
      for Attempt in 1 .. Most_Reads loop
         exit when (Device.UDP_CSR (Point) and Flags) = Flags;
      end loop;
   end Set;

   procedure Write_FIFO (Point : Endpoint; Data : Byte_Array) is
   begin
      for Item of Data loop
         Device.UDP_FDR (Point) := Word (Item);
      end loop;
      Set (Point, Packet_Ready);
   end Write_FIFO;

   procedure Read_FIFO (Point : Endpoint; Data : out Byte_Array) is
   begin
      for Item of Data loop
         Item := Byte (Device.UDP_FDR (Point) and 16#FF#);
      end loop;
   end Read_FIFO;

   --  Packets on their way

   type Packet is record
      Length : Packet_Length;
      Data   : Packet_Data;
   end record;

   type Place is mod Queue_Length;
   type Packets is array (Place) of Packet;

   type Queue is record
      Items  : Packets;
      Oldest : Place := 0;
      Count  : Natural range 0 .. Queue_Length := 0;
   end record;

   procedure Remove (From : in out Queue) is
   begin
      From.Oldest := From.Oldest + 1;
      From.Count := From.Count - 1;
   end Remove;

   --  The answer to a control request, sent in packets of the control endpoint

   type Reply is record
      Data  : Control_Data;
      First : Positive := 1;
      Last  : Natural := 0;
      Short : Boolean := False;
   end record;
   --  Data (First .. Last) is still to be sent. Short: the host expects more, so that an empty
   --  packet has to follow a full one.

   No_Address : constant := 0;

   protected Port with Interrupt_Priority => Priorities.USB_Interrupt is
      procedure Attach (Serial : Serial_Text);
      procedure Detach;
      procedure Send (Data : Byte_Array);
      procedure Receive (Data : out Packet_Data; Length : out Packet_Length);
      function Is_Configured return Boolean;
      function Free return Natural;
   private
      procedure Handle_Interrupt with Attach_Handler => Ada.Interrupts.Names.UDP;
      procedure Reset;
      procedure Configure (On : Boolean);
      procedure Handle_Control;
      procedure Handle_Request (Item : Request);
      procedure Start_Reply (Data : Byte_Array; Wanted : Natural);
      procedure Send_Reply;
      procedure Receive_Packets;
      procedure Send_Packet;
      Name      : Serial_Text := (others => '0');
      In_Use    : Boolean := False;
      Address   : Byte := No_Address;
      Answer    : Reply;
      Incoming  : Queue;
      Outgoing  : Queue;
      In_Flight : Boolean := False;
      Next_Bank : Word := Bank_0_Received;
   end Port;
   --  Address: given by the host, in force when the request has ended. In_Flight: the oldest
   --  outgoing packet is in the port.

   protected body Port is

      procedure Reset is
      begin
         In_Use := False;
         Address := No_Address;
         Answer.Last := 0;
         Device.UDP_RST_EP := 16#F#;
         Device.UDP_RST_EP := 0;
         Device.UDP_FADDR := Enable_Function;
         Device.UDP_CSR (Control_Point) := Enabled;
         Device.UDP_IDR := 16#F# or Bus_Events;
         Device.UDP_IER := Interrupt_Of (Control_Point);
         Configure (False);
      end Reset;

      procedure Configure (On : Boolean) is
      begin
         In_Use := On;
         Incoming.Count := 0;
         Outgoing.Count := 0;
         In_Flight := False;
         Next_Bank := Bank_0_Received;
         if On then
            Device.UDP_CSR (From_Host) := Enabled or Bulk_Out;
            Device.UDP_CSR (Into_Host) := Enabled or Bulk_In;
            Device.UDP_IER := Interrupt_Of (From_Host) or Interrupt_Of (Into_Host);
            Device.UDP_GLB_STAT := Registers.UDP.Configured;
         else
            Device.UDP_CSR (From_Host) := 0;
            Device.UDP_CSR (Into_Host) := 0;
         end if;
      end Configure;

      procedure Attach (Serial : Serial_Text) is
      begin
         Name := Serial;
         Device.UDP_TXVC := 0;
         Reset;
         PIOA.PIO_CODR := Bit (USB_Pull_Up);
      end Attach;

      procedure Detach is
      begin
         PIOA.PIO_SODR := Bit (USB_Pull_Up);
         Device.UDP_IDR := 16#F#;
         Device.UDP_TXVC := Disable_Transceiver;
         Configure (False);
      end Detach;

      procedure Send_Reply is
         Last : constant Natural := Natural'Min (Answer.Last, Answer.First + Control_Packet - 1);
      begin
         Write_FIFO (Control_Point, Answer.Data (Answer.First .. Last));
         Answer.Short := Answer.Short and then Last - Answer.First + 1 = Control_Packet;
         Answer.First := Last + 1;
      end Send_Reply;

      procedure Start_Reply (Data : Byte_Array; Wanted : Natural) is
         Count : constant Natural := Natural'Min (Data'Length, Wanted);
      begin
         Answer.Data (1 .. Count) := Data (Data'First .. Data'First + Count - 1);
         Answer.First := 1;
         Answer.Last := Count;
         Answer.Short := Count < Wanted;
         Send_Reply;
      end Start_Reply;

      procedure Handle_Request (Item : Request) is
      begin
         case Kind_Of (Item) is
            when Get_Device =>
               Start_Reply (Device_Descriptor, Requested_Length (Item));
            when Get_Configuration_Descriptor =>
               Start_Reply (Configuration_Descriptor, Requested_Length (Item));
            when Get_Languages =>
               Start_Reply (Languages, Requested_Length (Item));
            when Get_Serial =>
               Start_Reply (Text_Descriptor (Name), Requested_Length (Item));
            when Set_Address =>
               Address := Item (Value_Low);
               Start_Reply (Nothing, 0);
            when Set_Configuration =>
               Configure (Item (Value_Low) /= 0);
               Start_Reply (Nothing, 0);
            when Get_Configuration =>
               Start_Reply ((1 => (if In_Use then 1 else 0)), Requested_Length (Item));
            when Get_Status =>
               Start_Reply (Self_Powered_Status, Requested_Length (Item));
            when Accepted =>
               Start_Reply (Nothing, 0);
            when Unknown =>
               Set (Control_Point, Stall);
         end case;
      end Handle_Request;

      procedure Handle_Control is
         Flags : constant Word := Device.UDP_CSR (Control_Point);
         Item  : Request;
      begin
         if Has (Flags, Setup_Received) then
            Read_FIFO (Control_Point, Item);
            if Is_To_Host (Item) then
               Set (Control_Point, To_Host);
            else
               Clear (Control_Point, To_Host);
            end if;
            Clear (Control_Point, Setup_Received);
            Handle_Request (Item);
         elsif Has (Flags, Sent) then
            Clear (Control_Point, Sent);
            if Address /= No_Address then
               Device.UDP_FADDR := Enable_Function or Word (Address);
               Device.UDP_GLB_STAT := Addressed;
               Address := No_Address;
            elsif Answer.First <= Answer.Last or else Answer.Short then
               Send_Reply;
            end if;
         elsif Has (Flags, Stall_Sent) then
            Clear (Control_Point, Stall_Sent or Stall);
         elsif Has (Flags, Bank_0_Received) then
            Clear (Control_Point, Bank_0_Received);
         end if;
      end Handle_Control;

      --  Packets from the host, as long as there is room. Banks are filled in turn.
      procedure Receive_Packets is
         Flags : Word;
      begin
         loop
            Flags := Device.UDP_CSR (From_Host);
            exit when not Has (Flags, Next_Bank);
            if Incoming.Count = Queue_Length then
               Device.UDP_IDR := Interrupt_Of (From_Host);
               exit;
            end if;
            declare
               Slot : Packet renames Incoming.Items (Incoming.Oldest + Place (Incoming.Count));
            begin
               Slot.Length := Natural'Min (Received_Count (Flags), Packet_Size);
               Read_FIFO (From_Host, Slot.Data (1 .. Slot.Length));
            end;
            Incoming.Count := Incoming.Count + 1;
            Clear (From_Host, Next_Bank);
            Next_Bank := Next_Bank xor (Bank_0_Received or Bank_1_Received);
         end loop;
      end Receive_Packets;

      procedure Send_Packet is
      begin
         if Has (Device.UDP_CSR (Into_Host), Sent) then
            Clear (Into_Host, Sent);
            if In_Flight then
               Remove (Outgoing);
               In_Flight := False;
            end if;
         end if;
         if Outgoing.Count > 0 and then not In_Flight then
            In_Flight := True;
            declare
               Oldest : Packet renames Outgoing.Items (Outgoing.Oldest);
            begin
               Write_FIFO (Into_Host, Oldest.Data (1 .. Oldest.Length));
            end;
         end if;
      end Send_Packet;

      procedure Handle_Interrupt is
         Pending : constant Word := Device.UDP_ISR;
      begin
         if Has (Pending, End_Of_Reset) then
            Reset;
         end if;
         Device.UDP_ICR := Pending and Bus_Events;
         if Has (Pending, Interrupt_Of (Control_Point)) then
            Handle_Control;
         end if;
         if In_Use and then Has (Pending, Interrupt_Of (From_Host)) then
            Receive_Packets;
         end if;
         if In_Use and then Has (Pending, Interrupt_Of (Into_Host)) then
            Send_Packet;
         end if;
      end Handle_Interrupt;

      function Is_Configured return Boolean is (In_Use);

      function Free return Natural is (if In_Use then Queue_Length - Outgoing.Count else 0);

      procedure Send (Data : Byte_Array) is
      begin
         if Free > 0 then
            declare
               Slot : Packet renames Outgoing.Items (Outgoing.Oldest + Place (Outgoing.Count));
            begin
               Slot.Length := Data'Length;
               Slot.Data (1 .. Data'Length) := Data;
            end;
            Outgoing.Count := Outgoing.Count + 1;
            Send_Packet;
         end if;
      end Send;

      procedure Receive (Data : out Packet_Data; Length : out Packet_Length) is
         Oldest : Packet renames Incoming.Items (Incoming.Oldest);
      begin
         Length := 0;
         if In_Use and then Incoming.Count > 0 then
            Length := Oldest.Length;
            Data (1 .. Length) := Oldest.Data (1 .. Length);
            Remove (Incoming);
            Device.UDP_IER := Interrupt_Of (From_Host);
         end if;
      end Receive;

   end Port;

   procedure Attach (Serial : Serial_Text := "001653000000") is
   begin
      Port.Attach (Serial);
   end Attach;

   procedure Detach is
   begin
      Port.Detach;
   end Detach;

   function Configured return Boolean is (Port.Is_Configured);

   function Packets_Free return Natural is (Port.Free);

   procedure Send (Data : Byte_Array) is
   begin
      Port.Send (Data);
   end Send;

   procedure Receive (Data : out Packet_Data; Length : out Packet_Length) is
   begin
      Port.Receive (Data, Length);
   end Receive;

begin
   PMC.PMC.PMC_SCER := Port_Clock;
   PMC.PMC.PMC_PCER := Bit (UDP_Id) or Bit (PIOA_Id);
   PIOA.PIO_SODR := Bit (USB_Pull_Up);
   PIOA.PIO_OER := Bit (USB_Pull_Up);
   PIOA.PIO_PER := Bit (USB_Pull_Up);
   Device.UDP_TXVC := Disable_Transceiver;
end NXT.USB;
